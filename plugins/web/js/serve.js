/** The work of a worker: jobs in, results out. */

import { Tracer, initSync, write } from "../pkg/fieldtrace.js";

/** What the library throws is an error of the caller's; a trap of WebAssembly leaves the instance unusable. */
const isTrap = (error) => error instanceof WebAssembly.RuntimeError;

let tracer = { options: null, made: null };

/** Reading the networks takes a while, and most traces have the options of the one before. */
function tracerFor(options) {
    if (tracer.options !== options) {
        tracer.made?.free();
        tracer = { options: null, made: null };
        tracer = { options, made: new Tracer(options) };
    }
    return tracer.made;
}

function data(traced, title) {
    const lists = ["beziers", "counts", "widths", "profiles", "profileCounts", "colors", "closed", "dashes", "solidPaths", "solidColors"];
    const { width, height, dpi } = traced;
    const result = { width, height, dpi, title, drawing: traced.drawing(), graph: traced.graph() };
    for (const list of lists) result[list] = traced[list]();
    traced.free();
    return result;
}

const JOBS = {
    trace({ trace, load, name, bytes, pixels, watch }, say) {
        const report = watch ? (stage) => say({ stage }) : undefined;
        const found = watch ? (points) => say({ points }, [points.buffer]) : undefined;
        const made = tracerFor(trace);
        if (bytes) return data(made.file(name ?? "image", bytes, load, report, found), name);
        return data(made.pixels(pixels.data, pixels.width, pixels.height, load, report, found), name);
    },
    draw({ trace, graph, name }) {
        return data(tracerFor(trace).graph(graph), name);
    },
    write({ drawing, graph, title, format, options }) {
        return write(drawing, graph, title, format, JSON.stringify(options));
    },
};

/** Answers a message; `say(message, transfer)` sends. */
export function serve({ job, module }, say) {
    try {
        if (module) initSync({ module });
        const result = JOBS[job.kind](job, say);
        say({ result }, Object.values(result).filter(ArrayBuffer.isView).map((array) => array.buffer));
    } catch (error) {
        say({ error: error.message ?? String(error), alive: !isTrap(error) });
    }
}
