/** The functions of the package, whatever runs the workers and reads the images. */

import { Drawing } from "./drawing.js";
import { split } from "./options.js";

/** `pool` runs jobs, `read` makes `{ bytes, name }` or `{ pixels }` of an input. */
export function api(pool, read) {
    const made = (data) => new Drawing(data, (job) => pool.run({ kind: "write", ...job }));

    async function trace(input, { signal, onStage, onStroke, ...options } = {}) {
        signal?.throwIfAborted();
        const image = await read(input, signal);
        const watch = Boolean(onStage || onStroke);
        const tell = ({ stage, points }) => (stage ? onStage?.(stage) : onStroke?.(points));
        const copy = image.bytes?.buffer ?? image.pixels.data.buffer;
        const job = { kind: "trace", ...split(options), ...image, watch };
        return made(await pool.run(job, { transfer: [copy], signal, tell }));
    }

    async function draw(graph, { signal, ...options } = {}) {
        const text = typeof graph === "string" ? graph : JSON.stringify(graph);
        return made(await pool.run({ kind: "draw", graph: text, trace: split(options).trace }, { signal }));
    }

    return { trace, draw, end: () => pool.end() };
}
