/** Choosing and editing what is drawn, by pointer and by command. */

import { ends, join, length, nodeAt, points, remove } from "./edits.js";
import { box, endNear, nearestEnds, nodeNear, shapeAt, shapes } from "./hit.js";
import { doubtful, switched, ways } from "./pairing.js";

/** How near to something a pointer has to be, in pixels of the screen. */
const REACH = 12;

const NAMES = { strokes: "Stroke", dots: "Dot", fills: "Solid region" };

export class Tools {
    #desk;
    #stage;
    #say;
    #isEditing = false;
    #shape = null;
    #node = null;
    #doubtful = [];

    /** `say(text)` tells the user. */
    constructor(desk, stage, say) {
        this.#desk = desk;
        this.#stage = stage;
        this.#say = say;
    }

    get #graph() {
        return this.#desk.graph;
    }

    /** Whether a click changes what it hits. */
    set isEditing(isEditing) {
        this.#isEditing = isEditing;
        this.mark();
    }

    get hasShape() {
        return this.#shape !== null;
    }

    get hasOpenStroke() {
        return this.#shape?.list === "strokes" && !this.#graph.strokes[this.#shape.index].closed;
    }

    /** The place on the screen of what is chosen, if anything is. */
    get place() {
        const node = this.#doubtful.find(({ id }) => id === this.#node);
        if (node) return this.#stage.view.toScreen([node.x, node.y]);
        if (!this.#shape) return undefined;
        const [left, top, right, bottom] = box(this.#points(this.#shape));
        return this.#stage.view.toScreen([(left + right) / 2, (top + bottom) / 2]);
    }

    get junctions() {
        return this.#doubtful.length;
    }

    /** Takes the graph as it is now. What was chosen and is there no more is let go. */
    update() {
        this.#doubtful = this.#graph ? doubtful(this.#graph) : [];
        if (!this.#graph?.[this.#shape?.list]?.[this.#shape?.index]) this.#shape = null;
        if (!this.#doubtful.some(({ id }) => id === this.#node)) this.#node = null;
        this.mark();
    }

    clear() {
        this.#shape = this.#node = null;
        this.mark();
    }

    /** Shows what is chosen; `line` is one that is being drawn from an end to another. */
    mark(line = null) {
        const [graph, shape, node] = [this.#graph, this.#shape, this.#node];
        this.#stage.painter.marks = { graph, shape, node, doubtful: this.#doubtful, isEditing: this.#isEditing, line };
        this.#stage.painter.ask();
    }

    /** Whether strokes of a colour are drawn. */
    #takes() {
        const { strokes, solids } = this.#desk.drawing;
        const colors = new Set([...strokes, ...solids].map(({ color }) => color));
        return (color = "#000000") => colors.has(color);
    }

    #reach() {
        return REACH / this.#stage.view.scale;
    }

    #can() {
        return this.#graph && this.#desk.drawing && !this.#desk.isTracing;
    }

    /** The shape at a place on the screen, of those that are drawn or of all. */
    shapeAt(place, takes = this.#takes()) {
        return this.#graph && shapeAt(this.#graph, this.#stage.view.toPicture(place), this.#reach(), takes);
    }

    /** A click or a tap: chooses what is there; while editing, switches a junction or deletes a stroke. */
    tap(place) {
        if (!this.#can()) return;
        const node = this.#isEditing && nodeNear(this.#doubtful, this.#stage.view.toPicture(place), this.#reach());
        if (node) return this.#switch(node.id);
        const shape = this.shapeAt(place);
        if (this.#isEditing && shape) {
            this.#shape = null;
            return this.#remove(shape);
        }
        this.#shape = shape;
        this.#tellShape();
    }

    /** A drag from the end of a stroke, while editing. */
    grab(place) {
        const near = (at) => endNear(this.#graph, this.#stage.view.toPicture(at), this.#reach());
        const from = this.#isEditing && this.#can() ? near(place) : null;
        if (!from) return null;
        const { x, y } = nodeAt(this.#graph, from);
        return {
            move: (at) => this.mark([[x, y], this.#stage.view.toPicture(at)]),
            drop: (at) => {
                const to = near(at);
                if (to) this.#join(from, to);
                else this.#say("A stroke is joined where the drag ends at the end of a stroke.");
                this.mark();
            },
            cancel: () => this.mark(),
        };
    }

    /** Chooses the next stroke, or the one before. */
    next(step) {
        if (!this.#can()) return;
        const takes = this.#takes();
        const all = shapes(this.#graph).filter(({ list, index }) => takes(this.#graph[list][index].color));
        if (all.length === 0) return;
        const same = ({ list, index }) => list === this.#shape?.list && index === this.#shape?.index;
        const now = all.findIndex(same);
        this.#shape = all[now < 0 ? (step > 0 ? 0 : all.length - 1) : (now + step + all.length) % all.length];
        this.#tellShape();
    }

    /** Chooses the next doubtful junction, or the one before. */
    nextJunction(step) {
        if (!this.#can()) return;
        const all = this.#doubtful;
        if (all.length === 0) return this.#say("No junction is doubtful.");
        const now = all.findIndex(({ id }) => id === this.#node);
        const node = all[now < 0 ? 0 : (now + step + all.length) % all.length];
        this.#shape = null;
        this.#node = node.id;
        this.#show([node.x, node.y, node.x, node.y]);
        const sure = `${Math.round(100 * node.confidence)} % sure`;
        this.#say(`Junction ${all.indexOf(node) + 1} of ${all.length}, ${sure}, ${this.#ways(node.id)} ways to pair.`);
    }

    #points({ list, index }) {
        const item = this.#graph[list][index];
        if (list === "strokes") return points(this.#graph, index);
        return list === "fills" ? item.rings.flat() : [[item.x, item.y]];
    }

    #ways(node) {
        return ways(this.#graph, node).length;
    }

    #show(bounds) {
        this.#stage.reveal(bounds);
        this.mark();
    }

    #tellShape() {
        this.#node = null;
        if (!this.#shape) return this.mark();
        const { list, index } = this.#shape;
        const item = this.#graph[list][index];
        this.#show(box(this.#points(this.#shape)));
        const size = list === "strokes" ? `, ${Math.round(length(this.#graph, item.edges))} px long` : "";
        this.#say(`${NAMES[list]} ${index + 1} of ${this.#graph[list].length}${size}, ${item.color ?? "#000000"}.`);
    }

    /** Deletes what is chosen; what comes after it is chosen next. */
    remove() {
        if (this.#can() && this.#shape) this.#remove(this.#shape);
    }

    #remove(shape) {
        this.#desk.edit(remove(this.#graph, shape));
        this.#say(`${NAMES[shape.list]} deleted, ${this.#graph[shape.list].length} left.`);
    }

    /** Joins the stroke that is chosen with the end that is nearest to one of its own. */
    join() {
        if (!this.#can() || !this.hasOpenStroke) return;
        const found = nearestEnds(this.#graph, this.#shape.index);
        if (found) this.#join(...found);
        else this.#say("There is no end to join it with.");
    }

    #join(from, to) {
        const before = this.#graph;
        const graph = join(before, from, to);
        if (graph === before) return;
        this.#shape = null;
        this.#desk.edit(graph);
        this.#say(`${from.stroke === to.stroke ? "Stroke closed" : "Two strokes joined"}, ${ends(graph).length} ends left.`);
    }

    /** Pairs the arms of the junction that is chosen, or of the most doubtful one, in the next way. */
    switch() {
        if (!this.#can() || this.#doubtful.length === 0) return;
        if (this.#node === null) this.nextJunction(1);
        this.#switch(this.#node);
    }

    #switch(node) {
        this.#node = node;
        this.#shape = null;
        this.#desk.edit(switched(this.#graph, node));
        this.#say(`Arms paired anew, one of ${this.#ways(node)} ways; ${this.#graph.strokes.length} strokes.`);
    }
}
