/** The edits of stroke graphs, on small graphs made by hand. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { ends, join, length, nodeAt, remove } from "../page/edits.js";
import { endNear, nearestEnds, shapeAt } from "../page/hit.js";
import { History } from "../page/history.js";
import { doubtful, switched, ways } from "../page/pairing.js";
import { View } from "../page/view.js";

const node = (id, x, y, kind = "free-end", confidence = 1) => ({ id, kind, x, y, confidence });
const edge = (id, from, to, points) => ({ id, from, to, points, widths: points.map(() => 2), noise: 0 });
const step = (edge, reversed = false) => ({ edge, reversed });
const stroke = (edges, color = "#000000", closed = false) => ({ edges, closed, color });
const head = { format: "fieldtrace-graph", version: 1, width: 100, height: 100, dpi: null, line_width: 2 };

/** Two strokes that cross at (50, 50): one across, walked in two edges of which the second is reversed, one down. */
const cross = () => ({
    ...head,
    nodes: [node(0, 10, 50), node(1, 90, 50), node(2, 50, 10), node(3, 50, 90), node(7, 50, 50, "crossing", 0.4)],
    edges: [
        edge(10, 0, 7, [[10, 50], [50, 50]]),
        edge(11, 1, 7, [[90, 50], [50, 50]]),
        edge(12, 2, 7, [[50, 10], [50, 50]]),
        edge(13, 7, 3, [[50, 50], [50, 90]]),
    ],
    strokes: [stroke([step(10), step(11, true)], "#ff0000"), stroke([step(12), step(13)])],
    dots: [{ x: 80, y: 80, diameter: 6, color: "#000000" }],
    fills: [{ rings: [[[0, 0], [30, 0], [30, 30], [0, 30]], [[10, 10], [20, 10], [20, 20], [10, 20]]], color: "#00ff00" }],
});

/** A square walked from its corner at node 0, closed, through a doubtful node 1 where a stroke ends. */
const loop = () => ({
    ...head,
    nodes: [node(0, 10, 10, "seam"), node(1, 30, 30, "tee", 0.5), node(2, 60, 60)],
    edges: [
        edge(0, 0, 1, [[10, 10], [30, 10], [30, 30]]),
        edge(1, 1, 0, [[30, 30], [10, 30], [10, 10]]),
        edge(2, 2, 1, [[60, 60], [30, 30]]),
    ],
    strokes: [stroke([step(0), step(1)], "#000000", true), stroke([step(2)])],
});

/** Fails unless every stroke is a trail, no edge is in two, and all that strokes have is there. */
function assertSound(graph) {
    const edges = new Map(graph.edges.map((item) => [item.id, item]));
    const nodes = new Set(graph.nodes.map(({ id }) => id));
    const walked = graph.strokes.flatMap(({ edges }) => edges.map(({ edge }) => edge));
    assert.equal(new Set(walked).size, walked.length, "an edge is in two strokes");
    for (const { from, to } of graph.edges) assert.ok(nodes.has(from) && nodes.has(to), "a node is missing");
    for (const { edges: steps, closed } of graph.strokes) {
        const ways = steps.map(({ edge, reversed }) => [edges.get(edge).from, edges.get(edge).to][reversed ? "toReversed" : "slice"]());
        ways.slice(1).forEach(([start], i) => assert.equal(start, ways[i][1], "a trail is broken"));
        if (closed) assert.equal(ways[0][0], ways.at(-1)[1], "a closed stroke is open");
    }
}

/** The strokes as the sets of their edges. */
const trails = ({ strokes }) => strokes.map(({ edges }) => edges.map(({ edge }) => edge).sort().join(" ")).sort();

test("a stroke is deleted with its edges and the nodes that nothing else uses", () => {
    const graph = cross();
    const left = remove(graph, { list: "strokes", index: 0 });
    assertSound(left);
    assert.deepEqual(left.nodes.map(({ id }) => id), [2, 3, 7]);
    assert.deepEqual(left.edges.map(({ id }) => id), [12, 13]);
    assert.deepEqual(graph, cross(), "the graph before is as it was");
    assert.equal(remove(graph, { list: "dots", index: 0 }).dots.length, 0);
    assert.equal(remove(graph, { list: "fills", index: 0 }).fills.length, 0);
});

test("two ends are joined by a straight edge, whichever ends they are", () => {
    for (const from of [false, true]) {
        for (const to of [false, true]) {
            const graph = cross();
            const joined = join(graph, { stroke: 0, atEnd: from }, { stroke: 1, atEnd: to });
            assertSound(joined);
            assert.deepEqual(graph, cross());
            assert.equal(joined.strokes.length, 1);
            assert.equal(joined.strokes[0].color, "#ff0000");
            const [a, b] = [nodeAt(graph, { stroke: 0, atEnd: from }), nodeAt(graph, { stroke: 1, atEnd: to })];
            const bridge = joined.edges.at(-1);
            assert.deepEqual([bridge.points[0], bridge.points.at(-1)], [[a.x, a.y], [b.x, b.y]]);
            assert.equal(bridge.widths.length, bridge.points.length);
            const kinds = joined.nodes.filter(({ id }) => id === a.id || id === b.id).map(({ kind }) => kind);
            assert.deepEqual(kinds, ["corner", "corner"]);
        }
    }
});

test("the two ends of a stroke are joined to close it, and an end with itself is not", () => {
    const graph = cross();
    const closed = join(graph, { stroke: 0, atEnd: false }, { stroke: 0, atEnd: true });
    assertSound(closed);
    assert.ok(closed.strokes[0].closed);
    assert.equal(closed.strokes.length, 2);
    assert.equal(join(graph, { stroke: 0, atEnd: true }, { stroke: 0, atEnd: true }), graph);
});

test("ends at one node are joined there, and ends very near each other become one node", () => {
    const graph = cross();
    let apart = graph;
    while (apart.strokes.length < 4) apart = switched(apart, 7);
    const [first, second] = [0, 2].map((stroke) => ends(apart, stroke).find((end) => nodeAt(apart, end).id === 7));
    const met = join(apart, first, second);
    assertSound(met);
    assert.equal(met.edges.length, 4, "no edge is added");
    assert.deepEqual(trails(met), ["10 12", "11", "13"]);
    const near = { ...graph, nodes: [...graph.nodes, node(20, 11, 50.5), node(21, 11, 99)] };
    near.edges = [...graph.edges, edge(30, 20, 21, [[11, 50.5], [11, 99]])];
    near.strokes = [...graph.strokes, stroke([step(30)])];
    const joined = join(near, { stroke: 2, atEnd: false }, { stroke: 0, atEnd: false });
    assertSound(joined);
    assert.equal(joined.edges.length, 5, "no edge is added");
    assert.equal(joined.nodes.length, near.nodes.length - 1);
    const { x, y } = joined.nodes.find(({ id }) => id === 20);
    assert.deepEqual([x, y], [10.5, 50.25]);
});

test("a crossing pairs its arms in each of ten ways, once around, the smoothest first", () => {
    const graph = cross();
    const all = ways(graph, 7);
    assert.equal(all.length, 10);
    assert.deepEqual(trails({ strokes: graph.strokes }), ["10 11", "12 13"]);
    assert.equal(all[0].pairs.length, 2, "straight on is the smoothest");
    let now = graph;
    const seen = new Set();
    for (let i = 0; i < all.length; i += 1) {
        now = switched(now, 7);
        assertSound(now);
        seen.add(trails(now).join(", "));
    }
    assert.equal(seen.size, 10);
    const looks = ({ strokes }) => strokes.map(({ edges, color }) => `${color} ${edges.map(({ edge }) => edge).sort()}`).sort();
    assert.deepEqual(looks(now), looks(graph));
    assert.deepEqual(graph, cross());
});

test("a stroke has the colour that most of it had, whatever was tried before", () => {
    const graph = cross();
    graph.edges[0] = edge(10, 0, 7, [[10, 50], [10, 5], [50, 50]]);
    let now = graph;
    do now = switched(now, 7);
    while (trails(now).join(", ") !== "10 12, 11, 13");
    assert.equal(now.strokes.find(({ edges }) => edges.some(({ edge }) => edge === 10)).color, "#ff0000");
    assert.equal(now.strokes.find(({ edges }) => edges.some(({ edge }) => edge === 13)).color, "#000000");
});

test("a loop is opened at a junction, led on, and closed again", () => {
    const graph = loop();
    const all = ways(graph, 1);
    assert.equal(all.length, 4);
    let now = graph;
    const seen = new Set();
    for (const _ of all) {
        now = switched(now, 1);
        assertSound(now);
        seen.add(JSON.stringify(now.strokes));
    }
    assert.equal(seen.size, 4);
    assert.deepEqual(trails(now), trails(graph));
    assert.ok(now.strokes.some(({ closed }) => closed));
});

test("junctions are doubtful where they are not sure and more than one arm is there", () => {
    assert.deepEqual(doubtful(cross()).map(({ id }) => id), [7]);
    const sure = cross();
    sure.nodes[4].confidence = 0.9;
    sure.nodes[0].confidence = 0.1;
    assert.deepEqual(doubtful(sure), []);
});

test("what is near is found", () => {
    const graph = cross();
    assert.deepEqual(shapeAt(graph, [20, 51], 2), { list: "strokes", index: 0 });
    assert.deepEqual(shapeAt(graph, [51, 80], 2), { list: "strokes", index: 1 });
    assert.deepEqual(shapeAt(graph, [82, 81], 2), { list: "dots", index: 0 });
    assert.deepEqual(shapeAt(graph, [5, 5], 2), { list: "fills", index: 0 });
    assert.equal(shapeAt(graph, [15, 15], 2), null, "in the hole of a region");
    assert.equal(shapeAt(graph, [20, 51], 2, (color) => color !== "#ff0000"), null, "what is not drawn is not hit");
    assert.deepEqual(endNear(graph, [89, 51], 3), { stroke: 0, atEnd: true });
    assert.equal(endNear(graph, [50, 50], 3), null);
    const [from, to] = nearestEnds(graph, 0);
    assert.equal(from.stroke, 0);
    assert.equal(to.stroke, 1);
    assert.equal(length(graph, graph.strokes[0].edges), 80);
});

test("undo and redo go through the states, and a new state drops what was undone", () => {
    const history = new History();
    assert.equal(history.now, null);
    ["a", "b", "c"].forEach((state) => history.push(state));
    history.undo();
    history.undo();
    history.undo();
    assert.equal(history.now, "a");
    assert.equal(history.canUndo, false);
    history.redo();
    history.push("d");
    assert.equal(history.now, "d");
    assert.equal(history.canRedo, false);
    for (let i = 0; i < 500; i += 1) history.push(i);
    let steps = 0;
    for (; history.canUndo; steps += 1) history.undo();
    assert.equal(steps, 199);
});

test("a zoom keeps the place under the pointer, and what is chosen comes into view", () => {
    const view = new View();
    view.fit({ width: 400, height: 200 }, { width: 800, height: 600 });
    const before = view.toPicture([300, 280]);
    view.zoom(7, [300, 280]);
    view.toPicture([300, 280]).forEach((v, i) => assert.ok(Math.abs(v - before[i]) < 1e-9));
    view.reveal([390, 190, 395, 195], { width: 800, height: 600 });
    const [x, y] = view.toScreen([395, 195]);
    assert.ok(x > 0 && x < 800 && y > 0 && y < 600);
    for (let i = 0; i < 50; i += 1) view.zoom(2, [0, 0]);
    assert.equal(view.scale, 80);
});
