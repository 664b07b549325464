/** What the declarations promise, for the compiler alone to check. */

import { Drawing, draw, end, trace, type Graph, type TraceOptions } from "fieldtrace";

const options: TraceOptions = { preset: "plan", width: 3, maxWidth: { millimetres: 2 }, only: ["#c00000"], dpi: 300 };

export async function use(file: Blob, signal: AbortSignal): Promise<string> {
    const onStroke = (points: Float32Array) => points.length;
    const drawing: Drawing = await trace(file, { ...options, signal, onStroke, onStage: (stage: string) => stage });
    const graph: Graph = drawing.graph;
    graph.strokes = graph.strokes.filter(({ closed }) => closed);
    const drawn = await draw(graph, { detail: 0.2, signal });
    const first: Float64Array | undefined = drawn.strokes[0]?.beziers;
    const bytes: Uint8Array = await drawn.encode("pdf");
    end();
    return `${first?.length} ${bytes.length} ${drawn.dpi ?? "none"} ${await drawn.toSVG({ units: "millimetres" })}`;
}

// @ts-expect-error: an option that there is not
trace(new Blob(), { colour: "red" });
// @ts-expect-error: a format that there is not
draw("{}").then((drawing) => drawing.encode("bmp"));
