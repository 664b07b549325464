/** Options as users write them, in the form that the library reads. */

/** Options of reading an image; all others are those of the trace. */
const LOAD = new Set(["maxPixels", "dpi", "size", "page", "crop"]);

const fixed = (value) => (typeof value === "number" ? { fixed: value } : value);

/** Short forms of values. */
const SHORT = {
    width: fixed,
    threshold: fixed,
    maxWidth: (value) => (typeof value === "number" ? { pixels: value } : value),
    dpi: (value) => (typeof value === "number" ? { x: value, y: value } : value),
};

/** The options of a trace and those of reading, each as JSON. */
export function split(options) {
    const trace = {};
    const load = {};
    for (const [name, value] of Object.entries(options)) {
        if (value !== undefined) (LOAD.has(name) ? load : trace)[name] = SHORT[name]?.(value) ?? value;
    }
    return { trace: JSON.stringify(trace), load: JSON.stringify(load) };
}
