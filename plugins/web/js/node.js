/** Centreline tracing in Node; `index.d.ts` says what is there. */

import { readFile } from "node:fs/promises";
import { availableParallelism } from "node:os";
import { Worker } from "node:worker_threads";
import { api } from "./api.js";
import { read } from "./input.js";
import { Pool } from "./pool.js";

/** More workers than this hardly ever have something to do at a time. */
const MOST_WORKERS = 4;

let module;
const compiled = async () => WebAssembly.compile(await readFile(new URL("../pkg/fieldtrace_bg.wasm", import.meta.url)));

function spawn() {
    const worker = new Worker(new URL("./node-worker.js", import.meta.url));
    let isFresh = true;
    let fail;
    return {
        async post(job, transfer) {
            try {
                const message = isFresh ? { job, module: await (module ??= compiled()) } : { job };
                isFresh = false;
                worker.postMessage(message, transfer);
            } catch (error) {
                module = undefined;
                fail(error);
            }
        },
        listen(hear, failed) {
            fail = failed;
            // A process ends when nothing is left to do, though workers wait for more.
            worker.ref();
            const idle = (end) => (value) => (worker.unref(), end(value));
            worker.removeAllListeners();
            worker.on("message", (message) => ("result" in message || "error" in message ? idle(hear) : hear)(message));
            worker.on("error", idle(failed));
        },
        end: () => void worker.terminate(),
    };
}

async function decode(blob) {
    throw new Error(`${blob.name ?? "image"}: is no PNG, JPEG, TIFF, BMP or PNM; others are given as pixels, such as ImageData`);
}

export const { trace, draw, end } = api(new Pool(spawn, Math.min(MOST_WORKERS, availableParallelism())), (input) =>
    read(input, decode),
);
export { Drawing } from "./drawing.js";
