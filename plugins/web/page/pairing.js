/** How the arms of a junction pair into strokes. An arm is an end of an edge that is drawn: "12 from" or "12 to". */

import { edgeOf, length, nodeOf, turned } from "./edits.js";

/** Junctions of less confidence are worth a look (empirical). */
const DOUBTFUL = 0.7;

/** An arm's direction is measured over this many line widths. */
const REACH = 3;

/** What an arm that ends costs, radians: two arms pair up rather than end where the stroke turns by less than twice that. */
const END = Math.PI / 6;

/** A junction of more arms has too many ways to go through one by one. */
const MOST_ARMS = 8;

const startArm = ([{ edge, reversed }]) => `${edge} ${reversed ? "to" : "from"}`;
const endArm = (steps) => startArm(turned(steps.slice(-1)));

/** The node at which an arm is. */
function nodeOfArm(graph, arm) {
    const [edge, side] = arm.split(" ");
    return edgeOf(graph, Number(edge))[side];
}

/** Places between the steps of a stroke at which it passes a node, each as the index of the step after. */
function passages(graph, { edges, closed }, node) {
    const passes = (i) => nodeOfArm(graph, startArm([edges[i]])) === node;
    return [...edges.keys()].filter((i) => (i > 0 || closed) && passes(i));
}

/** The pairs of arms through which strokes pass a node. */
function pairsNow(graph, node) {
    const pair = ({ edges }, i) => [endArm([edges.at(i - 1)]), startArm([edges[i]])];
    return graph.strokes.flatMap((stroke) => passages(graph, stroke, node).map((i) => pair(stroke, i)));
}

/** The arms at each node, by the nodes' ids. */
function armsByNode(graph) {
    const arms = new Map();
    for (const step of graph.strokes.flatMap(({ edges }) => edges)) {
        for (const arm of [startArm([step]), endArm([step])]) {
            const node = nodeOfArm(graph, arm);
            if (!arms.has(node)) arms.set(node, []);
            arms.get(node).push(arm);
        }
    }
    return arms;
}

/** The junctions whose pairing is doubtful, the least sure first. */
export function doubtful(graph) {
    const arms = armsByNode(graph);
    const has = (id, least) => (arms.get(id)?.length ?? 0) >= least && arms.get(id).length <= MOST_ARMS;
    const found = graph.nodes.filter(({ id, confidence = 1 }) => confidence < DOUBTFUL && has(id, 2));
    return found.sort((a, b) => a.confidence - b.confidence);
}

/** The direction in which an arm leaves its node. */
function heading(graph, arm) {
    const [id, side] = arm.split(" ");
    const { points } = edgeOf(graph, Number(id));
    const { x, y } = nodeOf(graph, nodeOfArm(graph, arm));
    const walk = side === "from" ? points : points.toReversed();
    const far = walk.find(([px, py]) => Math.hypot(px - x, py - y) > REACH * graph.line_width) ?? walk.at(-1);
    return Math.atan2(far[1] - y, far[0] - x);
}

/** All ways to pair some of the arms. */
function* matchings([first, ...rest]) {
    if (first === undefined) return yield [];
    yield* matchings(rest);
    for (const [i, other] of rest.entries()) {
        for (const pairs of matchings(rest.toSpliced(i, 1))) yield [[first, other], ...pairs];
    }
}

const name = (pairs) => pairs.map((pair) => pair.toSorted().join("+")).sort().join(", ");

/** All ways in which the arms of a node may pair, the smoothest first. */
export function ways(graph, node) {
    const arms = (armsByNode(graph).get(node) ?? []).sort();
    const headings = new Map(arms.map((arm) => [arm, heading(graph, arm)]));
    const turn = ([a, b]) => {
        const apart = Math.abs(headings.get(a) - headings.get(b));
        return Math.PI - Math.min(apart, 2 * Math.PI - apart);
    };
    const cost = (pairs) => pairs.reduce((sum, pair) => sum + turn(pair) - 2 * END, arms.length * END);
    return [...matchings(arms)].map((pairs) => ({ pairs, cost: cost(pairs) })).sort((a, b) => a.cost - b.cost);
}

/** A stroke as the pieces into which a node cuts it. */
function cut(graph, stroke, node) {
    const at = passages(graph, stroke, node);
    if (at.length === 0) return [stroke];
    const { edges, closed } = stroke;
    const walk = closed ? [...edges.slice(at[0]), ...edges.slice(0, at[0])] : edges;
    const starts = closed ? at.map((i) => i - at[0]) : [0, ...at];
    return starts.map((start, k) => ({ ...stroke, edges: walk.slice(start, starts[k + 1]), closed: false }));
}

/** The graph whose edges know how their strokes looked before any were paired anew, so that no way to pair loses it. */
function remembering(graph) {
    const looks = new Map();
    for (const { edges, color, dashes } of graph.strokes) {
        const look = { color, dashes };
        edges.forEach(({ edge }) => looks.set(edge, look));
    }
    return { ...graph, edges: graph.edges.map((edge) => (edge.look ? edge : { ...edge, look: looks.get(edge.id) })) };
}

/** How most of a trail looked. */
function lookOf(graph, steps) {
    const lengths = new Map();
    for (const step of steps) {
        const { look } = edgeOf(graph, step.edge);
        lengths.set(look, (lengths.get(look) ?? 0) + length(graph, [step]));
    }
    return [...lengths].reduce((most, other) => (other[1] > most[1] ? other : most))[0];
}

/** The strokes with two arms as one: two strokes become one, or one is closed. */
function glued(strokes, [armA, armB]) {
    const having = (arm) => strokes.find(({ edges, closed }) => !closed && [startArm(edges), endArm(edges)].includes(arm));
    const [a, b] = [having(armA), having(armB)];
    if (a === b) return strokes.map((stroke) => (stroke === a ? { ...a, closed: true } : stroke));
    const lead = endArm(a.edges) === armA ? a.edges : turned(a.edges);
    const follow = startArm(b.edges) === armB ? b.edges : turned(b.edges);
    const joined = { ...a, edges: [...lead, ...follow] };
    return strokes.filter((stroke) => stroke !== b).map((stroke) => (stroke === a ? joined : stroke));
}

/** The graph with the arms of a node paired in the next way, after the last in the first. */
export function switched(graph, node) {
    const all = ways(graph, node);
    const now = name(pairsNow(graph, node));
    const { pairs } = all[(all.findIndex((way) => name(way.pairs) === now) + 1) % all.length];
    const known = remembering(graph);
    const pieces = graph.strokes.flatMap((stroke) => cut(graph, stroke, node));
    const paired = pairs.reduce(glued, pieces);
    const old = new Set(graph.strokes);
    const strokes = paired.map((stroke) => (old.has(stroke) ? stroke : { ...stroke, ...lookOf(known, stroke.edges) }));
    // Strokes may turn sharply at a branch, as some ways make them.
    const nodes = graph.nodes.map((item) => (item.id === node ? { ...item, kind: "branch" } : item));
    return { ...known, nodes, strokes };
}
