/** What lies near a place in a stroke graph. Places are `[x, y]` in pixels of the picture. */

import { edgeOf, ends, nodeAt } from "./edits.js";

/** How far a place is from a piece of a line. */
function fromPiece([x, y], [ax, ay], [bx, by]) {
    const [dx, dy] = [bx - ax, by - ay];
    const squared = dx * dx + dy * dy;
    const t = squared > 0 ? Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / squared)) : 0;
    return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

const boxes = new WeakMap();

/** Left, top, right and bottom of points. */
export function box(points) {
    if (!boxes.has(points)) {
        const made = [Infinity, Infinity, -Infinity, -Infinity];
        for (const [x, y] of points) {
            made[0] = Math.min(made[0], x);
            made[1] = Math.min(made[1], y);
            made[2] = Math.max(made[2], x);
            made[3] = Math.max(made[3], y);
        }
        boxes.set(points, made);
    }
    return boxes.get(points);
}

/** How far a place is from a line; lines farther than `reach` are not looked at closely. */
function fromLine([x, y], points, reach) {
    const [left, top, right, bottom] = box(points);
    if (x < left - reach || x > right + reach || y < top - reach || y > bottom + reach) return Infinity;
    let least = Infinity;
    for (let i = 1; i < points.length; i += 1) least = Math.min(least, fromPiece([x, y], points[i - 1], points[i]));
    return least;
}

/** Whether a place is inside of outlines, by the even-odd rule. */
function isInside([x, y], rings) {
    let isIn = false;
    for (const ring of rings) {
        for (const [i, [bx, by]] of ring.entries()) {
            const [ax, ay] = ring.at(i - 1);
            if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) isIn = !isIn;
        }
    }
    return isIn;
}

/** The nearest of some items within reach; `distance(item)` says how far one is. */
function nearest(items, distance, reach) {
    let found = null;
    let least = reach;
    for (const item of items) {
        const far = distance(item);
        if (far <= least) [found, least] = [item, far];
    }
    return found;
}

/** Every stroke, dot and solid region of a graph, each as its list and its place there. */
export function shapes(graph) {
    return ["strokes", "dots", "fills"].flatMap((list) => (graph[list] ?? []).map((_, index) => ({ list, index })));
}

/** The shape at a place: a stroke or dot within reach, else the solid region around it. */
export function shapeAt(graph, place, reach, takes = () => true) {
    const distance = {
        strokes: ({ edges }) => Math.min(...edges.map(({ edge }) => fromLine(place, edgeOf(graph, edge).points, reach))),
        dots: ({ x, y, diameter }) => Math.max(0, Math.hypot(place[0] - x, place[1] - y) - diameter / 2),
        fills: ({ rings }) => (isInside(place, rings) ? reach : Infinity),
    };
    const taken = shapes(graph).filter(({ list, index }) => takes(graph[list][index].color));
    const lines = taken.filter(({ list }) => list !== "fills");
    const far = ({ list, index }) => distance[list](graph[list][index]);
    return nearest(lines, far, reach) ?? nearest(taken, far, reach);
}

const away = ([x, y], node) => Math.hypot(node.x - x, node.y - y);

/** The node within reach that is nearest. */
export const nodeNear = (nodes, place, reach) => nearest(nodes, (node) => away(place, node), reach);

/** The end of a stroke within reach that is nearest. */
export const endNear = (graph, place, reach) => nearest(ends(graph), (end) => away(place, nodeAt(graph, end)), reach);

/** The end of another stroke, or the other end of the same one, that is nearest to an end of a stroke: both. */
export function nearestEnds(graph, stroke) {
    const others = (from) => ends(graph).filter((to) => to.stroke !== from.stroke || to.atEnd !== from.atEnd);
    const pairs = ends(graph, stroke).flatMap((from) => others(from).map((to) => [from, to]));
    const gap = ([from, to]) => {
        const { x, y } = nodeAt(graph, from);
        return away([x, y], nodeAt(graph, to));
    };
    return nearest(pairs, gap, Infinity);
}
