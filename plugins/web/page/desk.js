/** The picture on the desk, its drawing, and the states that undo goes through. Tells of what happens by events. */

import { draw, trace } from "../js/index.js";
import { History } from "./history.js";

/** Options that act on the ink, before there is a graph; others act on a graph that is there, with its edits. */
const OF_INK = ["minLength", "maxWidth", "dashes"];

/** Whether a change of options asks for a new trace. */
function asksForTrace(before, after) {
    const differs = (name) => JSON.stringify(before[name]) !== JSON.stringify(after[name]);
    // The resolution that the picture itself tells is in its trace alone.
    return OF_INK.some(differs) || (before.dpi !== undefined && after.dpi === undefined);
}

export class Desk extends EventTarget {
    /** `{ blob, name }`. */
    picture = null;
    drawing = null;
    options = {};
    #history = new History();
    #shown = null;
    #running = null;
    #isDrawing = false;

    get graph() {
        return this.#history.now?.graph ?? null;
    }

    get isTracing() {
        return this.#running !== null;
    }

    get canUndo() {
        return this.#history.canUndo;
    }

    get canRedo() {
        return this.#history.canRedo;
    }

    #tell(type, detail) {
        this.dispatchEvent(new CustomEvent(type, { detail }));
    }

    /** Puts a picture on the desk and traces it. Where that fails or is stopped, the picture before comes back. */
    async open(picture) {
        const { picture: old } = this;
        const history = this.#history;
        this.#lay(picture, new History());
        const isTraced = await this.#trace();
        if (!isTraced && this.picture === picture) this.#lay(old, history);
    }

    #lay(picture, history) {
        this.picture = picture;
        this.#history = history;
        this.#shown = null;
        this.drawing = null;
        // The size in millimetres is that of one picture.
        this.options = history.now?.options ?? { ...this.options, dpi: undefined };
        this.#tell("picture");
        this.#tell("options");
        this.#redraw();
    }

    /** Stops the trace that runs. */
    stop() {
        this.#running?.abort();
    }

    /** Traces the picture anew. Gives whether it came to its end. */
    async #trace() {
        this.stop();
        const running = new AbortController();
        this.#running = running;
        const { options } = this;
        const onStage = (stage) => this.#running === running && this.#tell("stage", stage);
        const onStroke = (points) => this.#running === running && this.#tell("found", points);
        this.#tell("start");
        try {
            const drawing = await trace(this.picture.blob, { ...options, signal: running.signal, onStage, onStroke });
            this.#history.push({ graph: drawing.graph, options });
            this.#show(drawing);
            this.#tell("drawn");
            return true;
        } catch (error) {
            if (!running.signal.aborted) this.#tell("error", error.message);
            else if (this.#running === running) this.#tell("stopped");
            return false;
        } finally {
            if (this.#running === running) {
                this.#running = null;
                this.#tell("end");
            }
        }
    }

    /** Takes other options, and shows what comes of them. */
    async set(options) {
        const before = this.options;
        if (JSON.stringify(options) === JSON.stringify(before)) return;
        this.options = options;
        if (!this.picture) return;
        const mustTrace = this.isTracing || !this.graph || asksForTrace(before, options);
        if (!mustTrace) {
            await this.#step({ graph: this.graph, options });
            return this.#tell("drawn");
        }
        const { picture } = this;
        const isTraced = await this.#trace();
        if (isTraced || this.isTracing || this.picture !== picture || !this.#history.now) return;
        this.options = this.#history.now.options;
        this.#tell("options");
    }

    /** Takes a graph in place of the present one. */
    edit(graph) {
        this.#step({ graph, options: this.options });
    }

    #step(state) {
        this.#history.push(state);
        this.#tell("graph");
        return this.#redraw();
    }

    undo() {
        this.#history.undo();
        this.#back();
    }

    redo() {
        this.#history.redo();
        this.#back();
    }

    #back() {
        this.options = this.#history.now.options;
        this.#tell("options");
        this.#tell("graph");
        this.#redraw();
    }

    /** Draws the present state, and what has taken its place meanwhile. */
    async #redraw() {
        if (this.#isDrawing) return;
        this.#isDrawing = true;
        while (this.#history.now && this.#shown !== this.#history.now) {
            const { graph, options } = (this.#shown = this.#history.now);
            try {
                const drawing = await draw({ ...graph, dpi: options.dpi ?? graph.dpi }, options);
                if (this.#shown === this.#history.now) this.#show(drawing);
            } catch (error) {
                this.#tell("error", error.message);
            }
        }
        this.#isDrawing = false;
    }

    #show(drawing) {
        this.#shown = this.#history.now;
        this.drawing = drawing;
        this.#tell("drawing");
    }
}
