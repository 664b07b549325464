/** Centreline tracing of line drawings. Lengths are in pixels of the input, y points down. */

/** A file, its bytes, or pixels. Bytes are those of a PNG, JPEG, TIFF, BMP or PNM; browsers decode what else they know. */
export type Image =
    | Blob
    | ArrayBuffer
    | ArrayBufferView
    | { data: Uint8ClampedArray | Uint8Array; width: number; height: number }
    | HTMLImageElement
    | HTMLCanvasElement
    | OffscreenCanvas
    | ImageBitmap;

/** How strokes are fitted and drawn; the guide of the command says more of each. */
export interface FitOptions {
    /** Options for a kind of drawing, which others are laid over. */
    preset?: "sketch" | "plan" | "icon";
    /** Fit tolerance in line widths. */
    detail?: number;
    /** Strokes shorter than this many line widths are dropped. */
    minLength?: number;
    /** The width of strokes: those of pens, measured, one for all, a number of pixels, filled outlines, or along each stroke. */
    width?: "pens" | "measured" | "uniform" | "outline" | "profile" | number;
    /** What becomes of solid regions. */
    solids?: "fill" | "outline" | "hatch" | "drop";
}

/** Everything that a trace may be told. */
export interface TraceOptions extends FitOptions {
    /** Specks of at most this many pixels are removed; decided from the image by default. */
    despeckle?: number;
    /** How ink is told from the page. */
    ink?: "auto" | "learned" | "threshold";
    /** Darkness from which on a pixel is ink, 0 to 1. */
    threshold?: "auto" | number;
    /** Whether lines are light on dark. */
    invert?: "auto" | "yes" | "no";
    /** Up to how many pixels of width ink is a line. */
    maxWidth?: "auto" | "unlimited" | number | { millimetres: number };
    /** Breaks of at most this many line widths are bridged. */
    gap?: number;
    /** Whether dashes become dashed strokes. */
    dashes?: "keep" | "join";
    /** Colours, "#rrggbb", that alone are drawn. */
    only?: string[];
    /** Colours, "#rrggbb", that are not drawn. */
    ignore?: string[];
    /** How far a colour may be from one of those, 0 to 1. */
    colorTolerance?: number;
    /** Most pixels that an image may have. */
    maxPixels?: number;
    /** Dots per inch, in place of what the image says. */
    dpi?: number | { x: number; y: number };
    /** The page of a TIFF of several, from 1. */
    page?: number;
    /** The part to trace: x, y, width, height. */
    crop?: [number, number, number, number];
}

/** Who wants to know, and who may stop it. */
export interface Watch {
    /** Stops the trace, which then rejects with the signal's reason. */
    signal?: AbortSignal;
    /** Told of each stage as it begins. */
    onStage?(stage: "ink" | "directions" | "strokes" | "curves"): void;
    /** Told of the points of each streamline as it is found, x before y; strokes are made of these. */
    onStroke?(points: Float32Array): void;
}

/** How a drawing is written; the guide of the command says which format takes what. */
export interface WriteOptions {
    /** Decimals of coordinates. */
    precision?: number;
    /** The unit of coordinates in SVG and CSV. */
    units?: "pixels" | "millimetres";
    /** The elements of an SVG. */
    shapes?: "plain" | "path";
    /** The pieces of strokes. */
    curves?: "bezier" | "arcs" | "lines" | null;
    /** How far arcs and lines may leave the curve. */
    tolerance?: number;
    /** Distance between the points of a CSV. */
    step?: number;
}

export interface Stroke {
    /** Cubic Bezier pieces, eight numbers each: start, two handles, end; x before y. */
    readonly beziers: Float64Array;
    /** Width of the pen. */
    readonly width: number;
    /** Widths at even distances along the stroke, of drawings traced with the width "profile". */
    readonly widths: Float64Array | null;
    /** "#rrggbb". */
    readonly color: string;
    /** Whether the stroke ends where it starts. */
    readonly closed: boolean;
    /** Lengths of a dash and a gap, and how far into the pattern the stroke starts. */
    readonly dashes: [number, number, number] | null;
}

/** A region too wide to be a line. */
export interface Solid {
    /** Outlines as a path of SVG, inside by the even-odd rule. */
    readonly path: string;
    /** "#rrggbb". */
    readonly color: string;
}

export type Format = "svg" | "svgz" | "dxf" | "pdf" | "csv" | "json";

export class Drawing {
    readonly width: number;
    readonly height: number;
    /** Dots per inch, where they are known. */
    readonly dpi: number | null;
    readonly strokes: readonly Stroke[];
    readonly solids: readonly Solid[];
    /** The stroke graph as the command writes it with --graph; a copy, which may be changed and given to `draw`. */
    readonly graph: Graph;
    /** The bytes of a file. */
    encode(format: Format, options?: WriteOptions): Promise<Uint8Array>;
    toSVG(options?: WriteOptions): Promise<string>;
    toDXF(options?: WriteOptions): Promise<string>;
    toJSON(options?: WriteOptions): Promise<string>;
}

/** Where strokes meet and how they go on. */
export interface Graph {
    nodes: { id: number; kind: string; x: number; y: number; confidence: number }[];
    edges: { id: number; from: number; to: number; points: [number, number][]; widths: (number | null)[] | null; noise: number }[];
    strokes: { edges: { edge: number; reversed: boolean }[]; closed: boolean; color: string }[];
    [member: string]: unknown;
}

/** Traces an image. Rejects with the library's message where it cannot be read or an option is out of its range. */
export function trace(image: Image, options?: TraceOptions & Watch): Promise<Drawing>;

/** Draws a stroke graph. */
export function draw(graph: Graph | string, options?: FitOptions & Pick<Watch, "signal">): Promise<Drawing>;

/** Ends the workers that have nothing to do; later calls start new ones for as long as they run. */
export function end(): void;
