/** Paints strokes, and what is shown of the edit, over the picture. */

import { coloring } from "./colors.js";
import { edgeOf, ends, nodeAt } from "./edits.js";
import { pathOf } from "./paths.js";

/** From so many pixels of the screen for one of the picture, control points are shown. */
const CONTROLS = 5;

/** What was found and is not shown yet gets onto the page by this share in each frame. */
const REVEAL = 0.15;

/** A straight piece has no handles to be seen: they lie this near to it, in pixels. */
const STRAIGHT = 0.01;

export class Painter {
    #context;
    #view;
    #colors;
    #strokes = [];
    #solids = [];
    #waiting = [];
    #found = [];
    #isAsked = false;
    #isStale = true;
    /** What is shown of the edit: the graph, the shape and the junction that are chosen, the junctions that are doubtful. */
    marks = { graph: null, shape: null, node: null, doubtful: [], isEditing: false, line: null };
    /** How much of the strokes is seen, 0 to 1. */
    opacity = 1;

    constructor(canvas, view) {
        this.#context = canvas.getContext("2d");
        this.#view = view;
        this.#colors = getComputedStyle(document.documentElement);
    }

    /** Shows a drawing in place of what was there; `null` for none. Gives the legend of its colours. */
    show(drawing, by) {
        this.forget();
        const colors = drawing && drawing.strokes.length > 0 ? coloring(drawing, by) : { legend: [] };
        this.#strokes = (drawing?.strokes ?? []).map((stroke, i) => ({ ...pathOf(stroke), color: colors.stroke(stroke, i) }));
        this.#solids = (drawing?.solids ?? []).map(({ path, color }) => ({ path: new Path2D(path), color }));
        return colors.legend;
    }

    /** Takes away the lines that a trace has found. */
    forget() {
        this.#waiting = [];
        this.#found = [];
        this.ask();
    }

    /** Draws in the points of a line that a running trace has found. */
    find(points) {
        this.#waiting.push(points);
        this.#askForFrame();
    }

    /** Paints all anew with the next frame. */
    ask() {
        this.#isStale = true;
        this.#askForFrame();
    }

    #askForFrame() {
        if (this.#isAsked) return;
        this.#isAsked = true;
        requestAnimationFrame(() => {
            this.#isAsked = false;
            if (this.#isStale) this.#paint();
            this.#paintWaiting();
        });
    }

    #paint() {
        this.#isStale = false;
        const { canvas } = this.#context;
        const density = devicePixelRatio;
        const { scale, x, y } = this.#view;
        this.#context.setTransform(1, 0, 0, 1, 0, 0);
        this.#context.clearRect(0, 0, canvas.width, canvas.height);
        this.#context.setTransform(scale * density, 0, 0, scale * density, x * density, y * density);
        this.#context.lineCap = "round";
        this.#context.lineJoin = "round";
        const seen = this.#seen(canvas, density);
        const shown = this.#strokes.filter(({ bounds: [l, t, r, b] }) => l < seen[2] && r > seen[0] && t < seen[3] && b > seen[1]);
        this.#context.globalAlpha = this.opacity;
        this.#paintStrokes(shown);
        this.#context.globalAlpha = 1;
        this.#paintFound(this.#found);
        if (scale >= CONTROLS && this.opacity > 0) this.#paintControls(shown);
        if (this.marks.graph) this.#paintMarks();
    }

    /** Left, top, right and bottom of what is seen of the picture. */
    #seen({ width, height }, density) {
        return [...this.#view.toPicture([0, 0]), ...this.#view.toPicture([width / density, height / density])];
    }

    #paintStrokes(shown) {
        const context = this.#context;
        for (const { path, color } of this.#solids) {
            context.fillStyle = color;
            context.fill(path, "evenodd");
        }
        for (const { path, isFilled, color, stroke } of shown) {
            context.fillStyle = context.strokeStyle = color;
            context.lineWidth = stroke.width;
            context.setLineDash(stroke.dashes?.slice(0, 2) ?? []);
            context.lineDashOffset = stroke.dashes?.[2] ?? 0;
            if (isFilled) context.fill(path);
            else context.stroke(path);
        }
        context.setLineDash([]);
    }

    /** Paints what was found since on top of what is there: thousands of lines are too many to paint anew in each frame. */
    #paintWaiting() {
        const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
        const next = this.#waiting.splice(0, Math.ceil(this.#waiting.length * (still ? 1 : REVEAL)));
        this.#found.push(...next);
        this.#paintFound(next);
        if (this.#waiting.length > 0) this.#askForFrame();
    }

    #paintFound(lines) {
        this.#pen("--mark", 2);
        for (const points of lines) {
            this.#context.beginPath();
            for (let i = 0; i < points.length; i += 2) this.#context.lineTo(points[i], points[i + 1]);
            this.#context.stroke();
        }
    }

    /** Draws with a colour of the style sheet, a width on the screen. */
    #pen(color, width) {
        this.#context.strokeStyle = this.#context.fillStyle = this.#colors.getPropertyValue(color);
        this.#context.lineWidth = width / this.#view.scale;
    }

    #disc(x, y, radius) {
        this.#context.beginPath();
        this.#context.arc(x, y, radius / this.#view.scale, 0, 2 * Math.PI);
    }

    #line(points) {
        this.#context.beginPath();
        for (const [x, y] of points) this.#context.lineTo(x, y);
        this.#context.stroke();
    }

    #paintControls(shown) {
        this.#pen("--control", 1.5);
        this.#context.fillStyle = "#fff";
        for (const { stroke } of shown) {
            for (let i = 0; i < stroke.beziers.length; i += 8) this.#paintPiece(stroke.beziers.subarray(i, i + 8));
        }
    }

    #paintPiece([ax, ay, bx, by, cx, cy, dx, dy]) {
        const chord = Math.hypot(dx - ax, dy - ay) || 1;
        const off = (x, y) => Math.abs((x - ax) * (dy - ay) - (y - ay) * (dx - ax)) / chord;
        const isStraight = Math.max(off(bx, by), off(cx, cy)) < STRAIGHT;
        const handles = isStraight ? [] : [[[ax, ay], [bx, by]], [[dx, dy], [cx, cy]]];
        for (const [end, handle] of handles) {
            this.#line([end, handle]);
            this.#disc(...handle, 4);
            this.#context.fill();
            this.#context.stroke();
        }
        const size = 8 / this.#view.scale;
        for (const [x, y] of [[ax, ay], [dx, dy]]) {
            this.#context.fillRect(x - size / 2, y - size / 2, size, size);
            this.#context.strokeRect(x - size / 2, y - size / 2, size, size);
        }
    }

    #paintMarks() {
        const { shape, node, doubtful, isEditing, line } = this.marks;
        if (shape) this.#paintShape(shape);
        if (isEditing) this.#paintEnds();
        if (isEditing || node) this.#paintDoubtful(doubtful, node);
        if (line) {
            this.#pen("--mark", 3);
            this.#line(line);
        }
    }

    #paintShape({ list, index }) {
        const { graph } = this.marks;
        this.#pen("--chosen", 4);
        const item = graph[list][index];
        if (list === "strokes") item.edges.forEach(({ edge }) => this.#line(edgeOf(graph, edge).points));
        else if (list === "fills") item.rings.forEach((ring) => this.#line([...ring, ring[0]]));
        else {
            this.#disc(item.x, item.y, (item.diameter / 2) * this.#view.scale + 4);
            this.#context.stroke();
        }
    }

    #paintEnds() {
        const { graph } = this.marks;
        this.#pen("--mark", 2);
        for (const end of ends(graph)) {
            const { x, y } = nodeAt(graph, end);
            this.#disc(x, y, 4);
            this.#context.fillStyle = "#fff";
            this.#context.fill();
            this.#context.stroke();
        }
    }

    #paintDoubtful(doubtful, chosen) {
        for (const node of doubtful) {
            this.#pen("--doubt", node.id === chosen ? 4 : 2);
            this.#disc(node.x, node.y, node.id === chosen ? 13 : 10);
            this.#context.stroke();
        }
    }
}
