/** What a trace gave: strokes, solid regions, the stroke graph, and files in each format. */

const hex = (color) => `#${color.toString(16).padStart(6, "0")}`;

/** The parts of an array, of which `counts` says how long each is, `unit` numbers for each of them. */
function* parts(array, counts, unit) {
    let start = 0;
    for (const count of counts) {
        const end = start + count * unit;
        yield array.subarray(start, end);
        start = end;
    }
}

export class Drawing {
    #data;
    #write;

    /** What the worker sent, and what asks a worker for a file of it. */
    constructor(data, write) {
        this.#data = data;
        this.#write = write;
        this.width = data.width;
        this.height = data.height;
        this.dpi = data.dpi ?? null;
        const beziers = [...parts(data.beziers, data.counts, 8)];
        const profiles = [...parts(data.profiles, data.profileCounts, 1)];
        this.strokes = beziers.map((curve, i) => ({
            beziers: curve,
            width: data.widths[i],
            widths: profiles[i].length > 0 ? profiles[i] : null,
            color: hex(data.colors[i]),
            closed: data.closed[i] === 1,
            dashes: data.dashes[3 * i] > 0 ? [...data.dashes.subarray(3 * i, 3 * i + 3)] : null,
        }));
        this.solids = data.solidPaths.map((path, i) => ({ path, color: hex(data.solidColors[i]) }));
    }

    /** The stroke graph, a plain object; `draw` takes it after a change. */
    get graph() {
        return JSON.parse(this.#data.graph);
    }

    /** The bytes of a file in a format: svg, svgz, dxf, pdf, csv or json. */
    encode(format, options = {}) {
        const { drawing, graph, title } = this.#data;
        return this.#write({ drawing, graph, title, format, options });
    }

    async #text(format, options) {
        return new TextDecoder().decode(await this.encode(format, options));
    }

    toSVG(options) {
        return this.#text("svg", options);
    }

    toDXF(options) {
        return this.#text("dxf", options);
    }

    toJSON(options) {
        return this.#text("json", options);
    }
}
