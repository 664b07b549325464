/**
 * Edits of stroke graphs, plain objects in the library's JSON form. Each gives a new graph and leaves the old one as it
 * was; what did not change is shared by both, so that keeping many of them for undo costs little.
 */

/** Two ends nearer than this many line widths become one node; others are led to each other by a straight edge. */
const ONE_NODE = 1;

const maps = new WeakMap();

/** The items of a list of the graph by their ids. */
function byId(list) {
    if (!maps.has(list)) maps.set(list, new Map(list.map((item) => [item.id, item])));
    return maps.get(list);
}

export const edgeOf = (graph, id) => byId(graph.edges).get(id);
export const nodeOf = (graph, id) => byId(graph.nodes).get(id);

/** A trail walked the other way. */
export const turned = (steps) => steps.map(({ edge, reversed }) => ({ edge, reversed: !reversed })).reverse();

/** The node at which a stroke starts, or ends. */
export function nodeAt(graph, { stroke, atEnd }) {
    const { edge, reversed } = graph.strokes[stroke].edges.at(atEnd ? -1 : 0);
    const { from, to } = edgeOf(graph, edge);
    return nodeOf(graph, atEnd === Boolean(reversed) ? from : to);
}

/** The ends of all open strokes, or of one. */
export function ends(graph, only) {
    const of = (stroke) => [false, true].map((atEnd) => ({ stroke, atEnd }));
    const chosen = only === undefined ? graph.strokes.keys() : [only];
    return [...chosen].filter((stroke) => !graph.strokes[stroke].closed).flatMap(of);
}

/** The points of a stroke, edge by edge. */
export function points(graph, index) {
    const walked = ({ edge, reversed }) => {
        const { points } = edgeOf(graph, edge);
        return reversed ? points.toReversed() : points;
    };
    return graph.strokes[index].edges.flatMap(walked);
}

const lengths = new WeakMap();

function edgeLength({ points }) {
    if (!lengths.has(points)) {
        const steps = points.slice(1).map(([x, y], i) => Math.hypot(x - points[i][0], y - points[i][1]));
        lengths.set(points, steps.reduce((sum, step) => sum + step, 0));
    }
    return lengths.get(points);
}

/** The length of a trail. */
export const length = (graph, steps) => steps.reduce((sum, { edge }) => sum + edgeLength(edgeOf(graph, edge)), 0);

/** The graph without edges that no stroke has and nodes that no edge has. */
function pruned(graph) {
    const drawn = new Set(graph.strokes.flatMap(({ edges }) => edges.map(({ edge }) => edge)));
    const edges = graph.edges.filter(({ id }) => drawn.has(id));
    const used = new Set(edges.flatMap(({ from, to }) => [from, to]));
    return { ...graph, edges, nodes: graph.nodes.filter(({ id }) => used.has(id)) };
}

/** The graph without a stroke, a dot or a solid region: an item of one of its lists. */
export function remove(graph, { list, index }) {
    return pruned({ ...graph, [list]: graph[list].filter((_, i) => i !== index) });
}

/** The graph with two nodes as one, halfway between them. Edges follow their nodes when the graph is drawn. */
function merged(graph, a, b) {
    const both = { ...a, kind: "corner", x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
    const nodes = graph.nodes.filter(({ id }) => id !== b.id).map((node) => (node.id === a.id ? both : node));
    const kept = (id) => (id === b.id ? a.id : id);
    const moved = (edge) => ({ ...edge, from: kept(edge.from), to: kept(edge.to) });
    const edges = graph.edges.map((edge) => (edge.from === b.id || edge.to === b.id ? moved(edge) : edge));
    return { ...graph, nodes, edges };
}

/** The graph with a straight edge between two nodes, about half a pixel from point to point. */
function bridged(graph, a, b) {
    const count = Math.ceil(2 * Math.hypot(b.x - a.x, b.y - a.y)) + 1;
    const at = (t) => [a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)];
    const line = Array.from({ length: count }, (_, i) => at(i / (count - 1)));
    const id = Math.max(...graph.edges.map((edge) => edge.id)) + 1;
    const edge = { id, from: a.id, to: b.id, points: line, widths: line.map(() => null), noise: 0 };
    // Only there may the stroke turn sharply, and only where it does is it drawn so.
    const open = (node) => [a.id, b.id].includes(node.id) && ["free-end", "gap", "seam"].includes(node.kind);
    const nodes = graph.nodes.map((node) => (open(node) ? { ...node, kind: "corner" } : node));
    return { ...graph, nodes, edges: [...graph.edges, edge] };
}

/** The graph with an end of a stroke joined to an end of another, or to the other end of the same one. */
export function join(graph, from, to) {
    if (from.stroke === to.stroke && from.atEnd === to.atEnd) return graph;
    const [a, b] = [nodeAt(graph, from), nodeAt(graph, to)];
    const distance = Math.hypot(b.x - a.x, b.y - a.y);
    const isOne = a === b || distance < ONE_NODE * graph.line_width;
    const linked = a === b ? graph : isOne ? merged(graph, a, b) : bridged(graph, a, b);
    const bridge = isOne ? [] : [{ edge: linked.edges.at(-1).id, reversed: false }];
    const [first, second] = [graph.strokes[from.stroke], graph.strokes[to.stroke]];
    const lead = from.atEnd ? first.edges : turned(first.edges);
    const follow = to.atEnd ? turned(second.edges) : second.edges;
    const joined =
        first === second
            ? { ...first, edges: [...lead, ...bridge], closed: true }
            : { ...first, edges: [...lead, ...bridge, ...follow] };
    const kept = linked.strokes.filter((stroke) => stroke !== second || stroke === first);
    return { ...linked, strokes: kept.map((stroke) => (stroke === first ? joined : stroke)) };
}
