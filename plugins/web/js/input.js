/** Inputs as what a worker takes: a file's bytes, or pixels. What the caller holds is copied, for it is sent away. */

/** How the files begin that the library decodes as the command does; browsers decode others. */
const KNOWN = ["\x89PNG", "\xff\xd8\xff", "II*\0", "MM\0*", "II+\0", "MM\0+", "BM", "P1", "P2", "P3", "P4", "P5", "P6"];

const isKnown = (bytes) => {
    const start = String.fromCharCode(...bytes.subarray(0, 4));
    return KNOWN.some((magic) => start.startsWith(magic));
};

/** The bytes of a buffer or a view of one; null of anything else. */
function bytesOf(input) {
    if (input instanceof ArrayBuffer) return new Uint8Array(input.slice(0));
    if (ArrayBuffer.isView(input)) return new Uint8Array(input.buffer, input.byteOffset, input.byteLength).slice();
    return null;
}

/** Pixels as ImageData holds them; null of anything else. */
function pixelsOf({ data, width, height }) {
    if (!(data instanceof Uint8Array || data instanceof Uint8ClampedArray) || !(width > 0 && height > 0)) return null;
    return { data: Uint8Array.from(data), width, height };
}

/** Reads an input; `decode(blob)` gives the pixels of a file that the library does not know. */
export async function read(input, decode) {
    if (input instanceof Blob) {
        const bytes = new Uint8Array(await input.arrayBuffer());
        const name = input.name;
        return isKnown(bytes) ? { bytes, name } : { pixels: await decode(input), name };
    }
    const bytes = bytesOf(input);
    if (bytes) return isKnown(bytes) ? { bytes } : { pixels: await decode(new Blob([bytes])) };
    const pixels = input && pixelsOf(input);
    if (pixels) return { pixels };
    throw new TypeError("an image is a Blob, bytes, ImageData, an image element, an ImageBitmap or a canvas");
}
