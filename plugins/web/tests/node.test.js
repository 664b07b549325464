/** The package in Node, against the command. */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { after, test } from "node:test";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { Drawing, draw, end, trace } from "fieldtrace";
import { ends, join, remove } from "../page/edits.js";
import { nearestEnds } from "../page/hit.js";
import { doubtful, switched } from "../page/pairing.js";
import { difference, elements } from "./svg.js";

const { TRACE } = process.env;
const SAMPLES = new URL("../../../samples/", import.meta.url);
const NAMES = ["kettle.png", "plan.png", "boat.png", "leaf.jpg"];

const sample = (name) => readFileSync(new URL(name, SAMPLES));
const native = (name, ...options) => execFileSync(TRACE, [new URL(name, SAMPLES).pathname, "-o", "-", ...options]).toString();

/** All that the strokes of a drawing are, to the last bit. */
const shapes = ({ strokes, solids }) => JSON.stringify([strokes.map((s) => ({ ...s, beziers: [...s.beziers] })), solids]);

/** A drawing of lines, by pixels. */
function lines(width, height) {
    const data = new Uint8ClampedArray(4 * width * height).fill(255);
    const ink = (x, y) => data.fill(0, 4 * (y * width + x), 4 * (y * width + x) + 3);
    for (let y = 40; y < height - 40; y += 1) {
        for (let x = 40; x < width - 40; x += 1) {
            const wave = 30 * Math.sin(x / 60);
            if ((y + Math.round(wave)) % 120 < 4 || x % 250 < 3) ink(x, y);
        }
    }
    return { data, width, height };
}

after(end);

for (const name of NAMES) {
    test(`${name} gives the strokes that the command gives`, async () => {
        const drawing = await trace(sample(name));
        const precision = 4;
        const apart = difference(await drawing.toSVG({ precision }), native(name, "--format", "svg", "--precision", `${precision}`));
        console.log(`${name}: ${drawing.strokes.length} strokes, at most ${apart.toFixed(4)} px from the command's`);
        assert.ok(apart <= 0.01, `${apart}`);
    });
}

test("a graph that nobody changed is drawn as it was traced", async () => {
    const drawing = await trace(sample("boat.png"));
    const expected = await drawing.toSVG();
    for (const graph of [drawing.graph, await drawing.toJSON()]) {
        const drawn = await draw(graph);
        assert.equal(drawn.strokes.length, drawing.strokes.length);
        // Graphs are written with four decimals.
        assert.ok(difference(await drawn.toSVG(), expected) <= 0.011);
    }
});

test("graphs are drawn after each kind of edit", async () => {
    const { graph, strokes } = await trace(sample("kettle.png"));
    assert.equal((await draw(remove(graph, { list: "strokes", index: 0 }))).strokes.length, strokes.length - 1);
    const open = ends(graph)[0].stroke;
    assert.equal((await draw(join(graph, ...nearestEnds(graph, open)))).strokes.length, strokes.length - 1);
    const junctions = doubtful(graph);
    assert.ok(junctions.length > 0);
    for (const { id } of junctions) {
        let now = graph;
        for (let i = 0; i < 4; i += 1) {
            now = switched(now, id);
            const drawing = await draw(now);
            assert.equal(drawing.strokes.length, now.strokes.length);
        }
    }
});

test("options are those of the command", async () => {
    const drawing = await trace(sample("plan.png"), { preset: "plan", width: 3, detail: 0.3, gap: 2 });
    const options = ["--preset", "plan", "--width", "3", "--detail", "0.3", "--gap", "2"];
    assert.ok(difference(await drawing.toSVG(), native("plan.png", "--format", "svg", ...options)) <= 0.02);
    const outline = await trace(sample("kettle.png"), { width: "outline" });
    assert.deepEqual([outline.strokes.length > 0, outline.solids.length > 0], [false, true]);
    const profile = await trace(sample("kettle.png"), { width: "profile" });
    assert.ok(profile.strokes.every(({ widths }) => widths.length > 1));
});

test("wrong options are named", async () => {
    for (const [options, reason] of [
        [{ detail: 9 }, /detail.*9.*between/],
        [{ width: "broad" }, /width.*broad/],
        [{ colour: "red" }, /colour.*no such option/],
        [{ preset: "photo" }, /preset.*photo.*sketch/],
        [{ only: ["red"] }, /only.*red/],
        [{ maxPixels: 10 }, /pixels/],
    ]) {
        await assert.rejects(trace(sample("kettle.png"), options), reason);
    }
    const drawing = await trace(sample("kettle.png"));
    await assert.rejects(drawing.encode("bmp"), /bmp.*svg/);
});

test("what is no picture is told of", async () => {
    const cut = sample("boat.png").subarray(0, 5000);
    await assert.rejects(trace(cut), /image/);
    await assert.rejects(trace(new Uint8Array([1, 2, 3])), /PNG/);
    await assert.rejects(trace(new Blob([])), /PNG/);
    await assert.rejects(trace("kettle.png"), TypeError);
    await assert.rejects(draw("{"), /graph/);
    assert.ok((await trace(sample("kettle.png"))).strokes.length > 0, "and the next one is traced");
});

test("bytes, blobs and pixels give the same", async () => {
    const bytes = sample("kettle.png");
    const expected = shapes(await trace(bytes));
    for (const input of [new Blob([bytes]), new Uint8Array(bytes), new Uint8Array(bytes).buffer]) {
        assert.equal(shapes(await trace(input)), expected);
    }
    const page = lines(300, 300);
    const kept = page.data.slice();
    assert.ok((await trace(page)).strokes.length > 0);
    assert.deepEqual(page.data, kept, "what was given is as it was");
});

test("it tells how far it is", async () => {
    const [stages, found] = [[], []];
    const drawing = await trace(sample("leaf.jpg"), {
        onStage: (stage) => stages.push(stage),
        onStroke: (points) => found.push(points),
    });
    assert.deepEqual(stages, ["ink", "directions", "strokes", "curves"]);
    assert.ok(found.length > 0);
    for (const points of found) {
        assert.ok(points.length >= 4 && points.length % 2 === 0);
        assert.ok(points.every((v) => v >= 0 && v <= Math.max(drawing.width, drawing.height)));
    }
});

test("a trace is stopped before, at once, and on its way", async () => {
    await assert.rejects(trace(sample("leaf.jpg"), { signal: AbortSignal.abort() }), { name: "AbortError" });
    const early = new AbortController();
    const first = trace(sample("leaf.jpg"), { signal: early.signal });
    early.abort();
    await assert.rejects(first, { name: "AbortError" });
    const late = new AbortController();
    const onStage = (stage) => stage === "strokes" && late.abort(new Error("enough"));
    await assert.rejects(trace(sample("leaf.jpg"), { signal: late.signal, onStage }), /enough/);
    assert.ok((await trace(sample("leaf.jpg"))).strokes.length > 0, "and the next one comes to its end");
});

test("many at once each give their own", async () => {
    const jobs = Array.from({ length: 12 }, (_, i) => NAMES[i % NAMES.length]);
    const drawings = await Promise.all(jobs.map((name) => trace(sample(name))));
    const expected = new Map();
    for (const [i, name] of jobs.entries()) {
        if (!expected.has(name)) expected.set(name, shapes(drawings[i]));
        assert.equal(shapes(drawings[i]), expected.get(name));
    }
    assert.equal(new Set(expected.values()).size, NAMES.length);
});

test("files of every format", async () => {
    const drawing = await trace(sample("plan.png"));
    assert.ok(drawing instanceof Drawing);
    assert.deepEqual([drawing.width, drawing.height, drawing.dpi], [480, 360, 150]);
    assert.match(await drawing.toSVG({ units: "millimetres" }), /<svg height="60.96mm".*width="81.28mm"/);
    assert.equal(elements(await drawing.toSVG()).length, drawing.strokes.length + drawing.solids.length);
    assert.match(await drawing.toDXF(), /LINE[^]*EOF\s*$/);
    assert.deepEqual(JSON.parse(await drawing.toJSON()).strokes, drawing.graph.strokes);
    const start = async (format) => new TextDecoder("latin1").decode((await drawing.encode(format)).subarray(0, 5));
    assert.equal(await start("pdf"), "%PDF-");
    assert.equal(await start("csv"), "strok");
    assert.equal((await start("svgz")).slice(0, 2), "\x1f\x8b");
});

test("what browsers load is small", () => {
    const files = ["../pkg/fieldtrace_bg.wasm", "../pkg/fieldtrace.js"].map((path) => readFileSync(new URL(path, import.meta.url)));
    const size = (compress) => files.reduce((sum, file) => sum + compress(file).length, 0);
    const gzip = size((file) => gzipSync(file, { level: 9 }));
    const brotli = size((file) => brotliCompressSync(file, { params: { [constants.BROTLI_PARAM_QUALITY]: 11 } }));
    console.log(`bundle: ${size((file) => file)} bytes, gzip ${gzip}, brotli ${brotli}`);
    assert.ok(brotli < 2.5e6);
});

test("time", async () => {
    const page = lines(1000, 1000);
    for (const which of ["first", "second"]) {
        const start = performance.now();
        const { strokes } = await trace(page);
        console.log(`1 megapixel, ${which} time: ${strokes.length} strokes, ${((performance.now() - start) / 1000).toFixed(2)} s`);
        assert.ok(strokes.length > 10);
    }
});
