/** The form of options: what it holds as options of the library, and back. */

import { swatch } from "./swatch.js";

const MM_PER_INCH = 25.4;

/** Changes are taken when none has come for so long, milliseconds. */
const PAUSE = 300;

/** The fit is set in steps of the square root of two. */
const detailOf = (step) => Number((0.1 * 2 ** (step / 2)).toPrecision(2));
const stepOf = (detail) => Math.round(2 * Math.log2(detail / 0.1));

const numberOf = (field) => (field.value === "" || !field.validity.valid ? undefined : Number(field.value));

/** A choice, or the number beside it where the choice is "number". */
const choiceOf = (choice, number, usual) => (choice.value === "number" ? (numberOf(number) ?? usual) : choice.value);

export class OptionsForm {
    #form;
    #change;
    #pause;
    #size = null;
    /** Colours alone drawn, and colours left out. */
    #colors = { only: [], ignore: [] };

    /** `change(options)` is told of what was set, after a pause. */
    constructor(form, change) {
        this.#form = form;
        this.#change = change;
        form.addEventListener("input", () => this.#changed());
        form.addEventListener("submit", (event) => event.preventDefault());
        this.#showValues();
    }

    #changed() {
        this.#showValues();
        clearTimeout(this.#pause);
        this.#pause = setTimeout(() => this.#change(this.options), PAUSE);
    }

    get options() {
        const { detail, minLength, width, widthNumber, maxWidth, maxWidthNumber, solids, dashes, tolerance, millimetres } =
            this.#form.elements;
        const across = numberOf(millimetres);
        return {
            detail: detailOf(Number(detail.value)),
            minLength: numberOf(minLength),
            width: choiceOf(width, widthNumber, "pens"),
            maxWidth: choiceOf(maxWidth, maxWidthNumber, "auto"),
            solids: solids.value,
            dashes: dashes.checked ? "join" : "keep",
            only: this.#colors.only,
            ignore: this.#colors.ignore,
            colorTolerance: Number(tolerance.value),
            dpi: across && this.#size ? (this.#size.width * MM_PER_INCH) / across : undefined,
        };
    }

    /** Shows options, such as those that undo went back to. */
    set options(options) {
        const { detail, minLength, width, widthNumber, maxWidth, maxWidthNumber, solids, dashes, tolerance, millimetres } =
            this.#form.elements;
        const choose = (choice, number, value) => {
            choice.value = typeof value === "number" ? "number" : value;
            if (typeof value === "number") number.value = value;
        };
        detail.value = stepOf(options.detail);
        minLength.value = options.minLength ?? "";
        choose(width, widthNumber, options.width);
        choose(maxWidth, maxWidthNumber, options.maxWidth);
        solids.value = options.solids;
        dashes.checked = options.dashes === "join";
        tolerance.value = options.colorTolerance;
        this.#colors = { only: options.only, ignore: options.ignore };
        millimetres.value = options.dpi === undefined ? "" : ((this.#size.width * MM_PER_INCH) / options.dpi).toFixed(3);
        this.#showValues();
    }

    /** The size of the drawing, and its resolution where that is known. */
    set size({ width, height, dpi }) {
        this.#size = { width, height, dpi };
        const { millimetres } = this.#form.elements;
        if (document.activeElement !== millimetres) millimetres.placeholder = dpi ? this.#mm(width).toFixed(1) : "not known";
        this.#showValues();
    }

    #mm(pixels) {
        return (pixels / this.#size.dpi) * MM_PER_INCH;
    }

    /** Takes a colour to draw alone ("only") or to leave out ("ignore"). */
    take(list, color) {
        if (this.#colors[list].includes(color)) return;
        this.#setColors(list, [...this.#colors[list], color]);
    }

    #setColors(list, colors) {
        this.#colors = { ...this.#colors, [list]: colors };
        this.#changed();
    }

    #showValues() {
        const { detail, width, widthNumber, maxWidth, maxWidthNumber, tolerance, millimetres } = this.#form.elements;
        const output = (name) => this.#form.querySelector(`output[for="${name}"]`);
        output("detail").value = `${detailOf(Number(detail.value))} line widths`;
        output("tolerance").value = Number(tolerance.value).toFixed(2);
        widthNumber.parentElement.hidden = width.value !== "number";
        maxWidthNumber.parentElement.hidden = maxWidth.value !== "number";
        output("millimetres").value = this.#sizeText(numberOf(millimetres));
        for (const list of ["only", "ignore"]) this.#showColors(list);
    }

    #sizeText(across) {
        if (!this.#size) return "";
        const { width, height, dpi } = this.#size;
        if (!across && !dpi) return `${width} × ${height} px`;
        const wide = across ?? this.#mm(width);
        return `${wide.toFixed(1)} × ${((wide * height) / width).toFixed(1)} mm at ${((width * MM_PER_INCH) / wide).toFixed(0)} dpi`;
    }

    #showColors(list) {
        const chip = (color) => {
            const button = document.createElement("button");
            button.type = "button";
            button.className = "chip";
            button.setAttribute("aria-label", `${color}: take it off the list`);
            button.append(swatch(color), color, " ×");
            button.onclick = () => this.#setColors(list, this.#colors[list].filter((other) => other !== color));
            return button;
        };
        const place = this.#form.querySelector(`#${list}-colors`);
        place.replaceChildren(...this.#colors[list].map(chip));
        place.parentElement.hidden = this.#colors[list].length === 0;
    }
}
