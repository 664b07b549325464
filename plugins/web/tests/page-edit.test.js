/** What is shown of a drawing on the page, its options and its edits, in Chromium. */

import assert from "node:assert/strict";
import { after, afterEach, before, beforeEach, test } from "node:test";
import { SAMPLES, changed, choose, clickAt, counts, graphOf, inPicture, longestTask, onScreen, painted, picture, redrawn, start, svgOf, text, until } from "./browser.js";
import { ends, nodeAt, points } from "../page/edits.js";
import { doubtful } from "../page/pairing.js";
import { elements } from "./svg.js";

let chrome;
let page;
before(async () => (chrome = await start()));
after(() => chrome.end());
beforeEach(async () => (page = await chrome.open()));
afterEach(async () => {
    await page.context().close();
    assert.deepEqual(chrome.errors.splice(0), []);
});

const middle = (graph, stroke) => {
    const walk = points(graph, stroke);
    return walk[Math.floor(walk.length / 2)];
};
const widths = (svg) => [...new Set(elements(svg).map(({ width }) => width))];
const colors = (svg) => [...new Set(elements(svg).map(({ color }) => color))];
const frame = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

test("the slider fades between page and strokes", async () => {
    await choose(page, `${SAMPLES}kettle.png`);
    const seen = async (value) => {
        await page.fill("#fade", value);
        await frame();
        const opacity = await page.locator("#page").evaluate((image) => Number(getComputedStyle(image).opacity));
        return [opacity, (await painted(page)).count > 0];
    };
    assert.deepEqual(await seen("0"), [1, false]);
    assert.deepEqual(await seen("50"), [1, true]);
    assert.deepEqual(await seen("100"), [0, true]);
});

test("strokes are coloured by stroke, by pen, by width, and as their ink", async () => {
    await choose(page, `${SAMPLES}boat.png`);
    const pens = widths(await svgOf(page)).length;
    assert.ok(pens > 1);
    const seen = async (by) => {
        await page.selectOption("#coloring", by);
        await frame();
        return [(await painted(page)).colors.length, await page.locator("#legend li").count()];
    };
    assert.deepEqual(await seen("stroke"), [20, 0]);
    assert.deepEqual(await seen("pen"), [pens, pens]);
    assert.match(await text(page, "#legend"), /#000000, 4\.07 px: \d/);
    const [shown, legend] = await seen("width");
    assert.ok(shown === pens && legend === 3);
    assert.deepEqual(await seen("ink"), [1, 0]);
});

test("the wheel zooms in on the place under the pointer, up to control points, and a drag moves the picture", async () => {
    await choose(page, `${SAMPLES}kettle.png`);
    await page.selectOption("#coloring", "width");
    // Wheels tell their place in whole pixels.
    const end = nodeAt(await graphOf(page), { stroke: 5, atEnd: false });
    const [x, y] = (await onScreen(page, [end.x, end.y])).map(Math.round);
    const place = await inPicture(page, [x, y]);
    await page.mouse.move(x, y);
    const before = (await painted(page)).colors;
    for (let i = 0; i < 6; i += 1) await page.mouse.wheel(0, -200);
    await frame();
    const near = await onScreen(page, place);
    assert.ok(Math.hypot(near[0] - x, near[1] - y) < 1);
    const added = (await painted(page)).colors.filter((color) => !before.includes(color));
    assert.ok(added.includes(0xffffff), "the points are white with a dark rim");
    await page.mouse.down();
    await page.mouse.move(x + 90, y + 40, { steps: 5 });
    await page.mouse.up();
    const moved = await onScreen(page, place);
    assert.ok(Math.abs(moved[0] - x - 90) < 2 && Math.abs(moved[1] - y - 40) < 2);
    await page.click("#zoom-fit");
    assert.ok(Math.hypot(...(await onScreen(page, place)).map((v, i) => v - [x, y][i])) < 1);
});

test("thousands of strokes stay smooth", async () => {
    const many = await picture(page, { name: "many.png", width: 2000, height: 1000 }, (context) => {
        context.lineWidth = 3;
        for (let y = 10; y < 1000; y += 20) {
            for (let x = 10; x < 2000; x += 20) {
                context.beginPath();
                context.moveTo(x - 5, y + 4);
                context.quadraticCurveTo(x, y - 8, x + 5, y + 4);
                context.stroke();
            }
        }
    });
    await choose(page, many);
    const longest = await longestTask(page, async () => {
        await page.mouse.move(400, 400);
        await page.mouse.down();
        for (let i = 0; i < 10; i += 1) await page.mouse.move(400 + 10 * i, 400);
        await page.mouse.up();
        for (let i = 0; i < 5; i += 1) await page.mouse.wheel(0, -100);
        await page.click("#edit");
        await frame();
    });
    console.log(`${await text(page, "#status")} Longest task of pan, zoom and marks: ${longest.toFixed(0)} ms`);
    assert.equal((await graphOf(page)).strokes.length, 5000);
    assert.ok(longest < 1000);
});

test("a junction of low confidence is switched with a click, and undo and redo go back and forth", async () => {
    await choose(page, `${SAMPLES}boat.png`);
    const graph = await graphOf(page);
    const node = doubtful(graph)[0];
    await page.click("#edit");
    const seen = new Set([JSON.stringify(graph.strokes)]);
    for (let i = 0; i < 3; i += 1) {
        const now = await changed(page, () => clickAt(page, [node.x, node.y]));
        seen.add(JSON.stringify(now.strokes));
    }
    assert.equal(seen.size, 4, "three arms pair in four ways");
    for (let i = 0; i < 3; i += 1) await changed(page, () => page.click("#undo"));
    assert.equal(await page.isDisabled("#undo"), true);
    assert.deepEqual((await graphOf(page)).strokes, graph.strokes);
    await changed(page, () => page.keyboard.press("Control+y"));
    const last = await changed(page, () => page.keyboard.press("Control+Shift+Z"));
    assert.ok(seen.has(JSON.stringify(last.strokes)));
    await changed(page, () => page.keyboard.press("Control+z"));
});

test("a click deletes a stroke while editing, and chooses it else", async () => {
    await choose(page, `${SAMPLES}kettle.png`);
    const graph = await graphOf(page);
    await clickAt(page, middle(graph, 3));
    assert.match(await text(page, "#status"), /^Stroke 4 of 11, \d+ px long, #000000/);
    assert.equal((await graphOf(page)).strokes.length, 11);
    await page.click("#edit");
    const left = await changed(page, () => clickAt(page, middle(graph, 3)));
    assert.equal(left.strokes.length, 10);
    assert.equal(elements(await svgOf(page)).length, 10);
    assert.match(await text(page, "#status"), /10 left/);
    // A drag from a place without an end moves the picture, and deletes nothing.
    const [x, y] = await onScreen(page, middle(graph, 2));
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 50, y, { steps: 4 });
    await page.mouse.up();
    assert.equal((await graphOf(page)).strokes.length, 10);
});

test("a drag from an end to another joins two strokes", async () => {
    await choose(page, `${SAMPLES}boat.png`);
    const graph = await graphOf(page);
    await page.click("#edit");
    // Two rays of the sun, of which the ends lie alone.
    const free = ends(graph).filter((end) => nodeAt(graph, end).kind === "free-end" && nodeAt(graph, end).x > 280);
    const [from, to] = [free[0], free.find(({ stroke }) => stroke !== free[0].stroke)];
    const place = (end) => onScreen(page, [nodeAt(graph, end).x, nodeAt(graph, end).y]);
    const joined = await changed(page, async () => {
        await page.mouse.move(...(await place(from)));
        await page.mouse.down();
        await page.mouse.move(...(await place(to)), { steps: 6 });
        await page.mouse.up();
    });
    assert.deepEqual(counts(joined), [graph.strokes.length - 1, graph.edges.length + 1, graph.nodes.length]);
    assert.equal(ends(joined).length, ends(graph).length - 2);
    await page.mouse.move(...(await place(free.at(-1))));
    await page.mouse.down();
    await page.mouse.move(640, 60, { steps: 4 });
    await page.mouse.up();
    assert.match(await text(page, "#status"), /joined where the drag ends/);
});

test("fit and widths act on the edited graph, and a shortest stroke on the picture", async () => {
    await choose(page, `${SAMPLES}boat.png`);
    await page.click("#next");
    await changed(page, () => page.click("#delete"));
    const fine = elements(await svgOf(page));
    const coarse = elements(await redrawn(page, () => page.fill("[name=detail]", "6")));
    const numbers = (list) => list.reduce((sum, { shape }) => sum + shape.length, 0);
    assert.ok(numbers(coarse) < numbers(fine));
    assert.equal(coarse.length, 19);
    await redrawn(page, () => page.selectOption("[name=width]", "number"));
    const svg = await redrawn(page, () => page.fill("[name=widthNumber]", "7"));
    assert.deepEqual([elements(svg).length, ...widths(svg)], [19, 7]);
    const outlines = await redrawn(page, () => page.selectOption("[name=width]", "outline"));
    assert.deepEqual(widths(outlines), [0]);
    await redrawn(page, () => page.selectOption("[name=width]", "pens"));
    const long = await redrawn(page, () => page.fill("[name=minLength]", "20"));
    assert.ok(elements(long).length < 19);
    // The edit is one step back, with the options of then.
    await redrawn(page, () => page.click("#undo"));
    assert.equal(await page.inputValue("[name=minLength]"), "0.5");
    assert.equal((await graphOf(page)).strokes.length, 19);
});

test("broad ink is a line or a region, as the threshold says", async () => {
    const bars = await picture(page, { name: "bars.png", width: 400, height: 300 }, (context) => {
        context.fillStyle = "#000";
        context.fillRect(40, 60, 320, 4);
        context.fillRect(60, 140, 280, 24);
    });
    await choose(page, bars);
    await page.selectOption("[name=maxWidth]", "number");
    const become = async (value, lines, regions) => {
        await page.fill("[name=maxWidthNumber]", value);
        const graph = await until(page, graphOf, ({ strokes, fills }) => strokes.length === lines && fills.length === regions);
        assert.equal(elements(await svgOf(page)).length, graph.strokes.length + graph.fills.length);
    };
    await become("60", 2, 0);
    await become("12", 1, 1);
    await become("60", 2, 0);
});

test("colours are picked on the picture, to draw alone or to leave out", async () => {
    const two = await picture(page, { name: "two.png", width: 400, height: 300 }, (context) => {
        context.lineWidth = 5;
        for (const [color, y] of [["#c01010", 80], ["#1030c0", 160], ["#c01010", 240]]) {
            context.strokeStyle = color;
            context.beginPath();
            context.moveTo(40, y);
            context.bezierCurveTo(140, y - 60, 240, y + 60, 360, y);
            context.stroke();
        }
    });
    await choose(page, two);
    const graph = await graphOf(page);
    assert.equal(graph.strokes.length, 3);
    const blue = graph.strokes.findIndex((_, i) => Math.abs(middle(graph, i)[1] - 160) < 20);
    await page.click("#pick-ignore");
    const red = await redrawn(page, () => clickAt(page, middle(graph, blue)));
    assert.deepEqual([elements(red).length, colors(red).length], [2, 1]);
    assert.equal(await page.getAttribute("#pick-ignore", "aria-pressed"), "false");
    await redrawn(page, () => page.click("#ignore-colors button"));
    // What is drawn can be chosen from a list as well, without a pointer.
    await page.click("#pick-only");
    assert.equal(await page.locator("#inks button").count(), 2);
    const only = await redrawn(page, () => page.click(`#inks button:has-text("${graph.strokes[blue].color}")`));
    assert.deepEqual(colors(only), [graph.strokes[blue].color]);
    await redrawn(page, () => page.click("#undo"));
    assert.equal(await page.locator("#only-colors button").count(), 0);
});
