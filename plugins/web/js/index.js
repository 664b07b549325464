/** Centreline tracing in the browser; `index.d.ts` says what is there. */

import { api } from "./api.js";
import { read } from "./input.js";
import { Pool } from "./pool.js";

/** More workers than this hardly ever have something to do at a time. */
const MOST_WORKERS = 4;

let module;
const compiled = () => (module ??= WebAssembly.compileStreaming(fetch(new URL("../pkg/fieldtrace_bg.wasm", import.meta.url))));

function spawn() {
    const worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    let isFresh = true;
    let fail;
    return {
        async post(job, transfer) {
            try {
                const message = isFresh ? { job, module: await compiled() } : { job };
                isFresh = false;
                worker.postMessage(message, transfer);
            } catch (error) {
                module = undefined;
                fail(error);
            }
        },
        listen(hear, failed) {
            fail = failed;
            worker.onmessage = ({ data }) => hear(data);
            worker.onerror = ({ message }) => failed(new Error(message || "the worker could not be started"));
        },
        end: () => worker.terminate(),
    };
}

/** The pixels of what can be drawn on a canvas. */
function drawn(source, width, height) {
    const canvas = new OffscreenCanvas(width, height);
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.drawImage(source, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    return { data: new Uint8Array(data.buffer), width, height };
}

async function decode(blob) {
    let bitmap;
    try {
        bitmap = await createImageBitmap(blob);
    } catch {
        throw new Error(`${blob.name ?? "image"}: is no image that can be read`);
    }
    try {
        return drawn(bitmap, bitmap.width, bitmap.height);
    } finally {
        bitmap.close();
    }
}

async function readAny(input) {
    if (input instanceof HTMLImageElement) {
        await input.decode();
        return { pixels: drawn(input, input.naturalWidth, input.naturalHeight) };
    }
    if ([HTMLCanvasElement, OffscreenCanvas, ImageBitmap].some((kind) => input instanceof kind)) {
        return { pixels: drawn(input, input.width, input.height) };
    }
    return read(input, decode);
}

const size = Math.min(MOST_WORKERS, navigator.hardwareConcurrency ?? 1);
export const { trace, draw, end } = api(new Pool(spawn, size), readAny);
export { Drawing } from "./drawing.js";
