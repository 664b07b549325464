/** Choosing colours to draw alone or to leave out, on the picture or from a list. */

import { shapes } from "./hit.js";
import { swatch } from "./swatch.js";

const byId = (id) => document.getElementById(id);
const LISTS = ["only", "ignore"];

export class Picker {
    #desk;
    #stage;
    #tools;
    #form;
    #list = null;

    constructor(desk, stage, tools, form) {
        this.#desk = desk;
        this.#stage = stage;
        this.#tools = tools;
        this.#form = form;
        for (const list of LISTS) byId(`pick-${list}`).addEventListener("click", () => this.#start(this.#list === list ? null : list));
    }

    get isPicking() {
        return this.#list !== null;
    }

    stop() {
        this.#start(null);
    }

    /** Begins to pick for one of the lists; `null` ends it. */
    #start(list) {
        this.#list = list;
        for (const name of LISTS) byId(`pick-${name}`).setAttribute("aria-pressed", name === list);
        byId("pick-help").hidden = byId("inks").hidden = list === null;
        byId("stage").classList.toggle("picking", list !== null);
    }

    #take(color) {
        const list = this.#list;
        this.stop();
        this.#form.take(list, color);
    }

    /** Takes the colour at a place on the screen: that of the stroke there, else the picture's. Gives whether it was asked for. */
    pick(place) {
        if (!this.isPicking) return false;
        const shape = this.#tools.shapeAt(place, () => true);
        const color = shape ? colorOf(this.#desk.graph, shape) : this.#stage.colorAt(place);
        if (color) this.#take(color);
        return true;
    }

    /** Lists the colours of all that was traced, drawn or not. */
    update() {
        const { graph } = this.#desk;
        const colors = graph ? new Set(shapes(graph).map((shape) => colorOf(graph, shape))) : [];
        const item = (color) => {
            const button = document.createElement("button");
            button.type = "button";
            button.className = "chip";
            button.append(swatch(color), color);
            button.onclick = () => this.#take(color);
            const line = document.createElement("li");
            line.append(button);
            return line;
        };
        byId("inks").replaceChildren(...[...colors].map(item));
        if (!graph) this.stop();
    }
}

const colorOf = (graph, { list, index }) => graph[list][index].color ?? "#000000";
