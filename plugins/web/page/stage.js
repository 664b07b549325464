/** The picture and the strokes over it: their place, and which of both is seen. */

/** From so many pixels of the screen for one of the picture, its pixels are shown as squares. */
const SQUARES = 3;

export class Stage {
    #root;
    #sheet;
    #image;
    #canvas;
    #size = null;

    constructor(root, view, painter) {
        this.#root = root;
        this.#sheet = root.querySelector("#sheet");
        this.#image = root.querySelector("#page");
        this.#canvas = root.querySelector("#strokes");
        this.view = view;
        this.painter = painter;
        this.#image.addEventListener("load", () => this.#take(this.#image.naturalWidth, this.#image.naturalHeight));
        // Browsers cannot show all that can be traced, TIFF for one.
        this.#image.addEventListener("error", () => (this.#image.hidden = true));
        new ResizeObserver(() => this.#resize()).observe(root);
    }

    get #screen() {
        return { width: this.#root.clientWidth, height: this.#root.clientHeight };
    }

    /** Shows a picture; `null` for none. */
    lay(picture) {
        URL.revokeObjectURL(this.#image.src);
        this.#size = null;
        this.#image.hidden = picture === null;
        if (picture) this.#image.src = URL.createObjectURL(picture.blob);
        else this.#image.removeAttribute("src");
        this.painter.show(null);
    }

    /** Takes the size of a drawing, where the picture itself cannot be shown. */
    measure({ width, height }) {
        if (!this.#size) this.#take(width, height);
    }

    #take(width, height) {
        this.#size = { width, height };
        this.#sheet.style.width = `${width}px`;
        this.#sheet.style.height = `${height}px`;
        this.fit();
    }

    fit() {
        if (this.#size) this.view.fit(this.#size, this.#screen);
        this.#place();
    }

    pan(dx, dy) {
        this.view.pan(dx, dy);
        this.#place();
    }

    /** Zooms about a place on the screen, or its middle. */
    zoom(factor, place = [this.#screen.width / 2, this.#screen.height / 2]) {
        this.view.zoom(factor, place);
        this.#place();
    }

    reveal(bounds) {
        this.view.reveal(bounds, this.#screen);
        this.#place();
    }

    /** Fades from the page alone (0) over both (0.5) to the strokes alone (1). */
    fade(share) {
        this.#image.style.opacity = Math.min(1, 2 - 2 * share);
        this.painter.opacity = Math.min(1, 2 * share);
        this.painter.ask();
    }

    /** The colour of the picture at a place on the screen; `null` off the picture. */
    colorAt(place) {
        const [x, y] = this.view.toPicture(place).map(Math.floor);
        const { width, height } = this.#size;
        if (this.#image.hidden || x < 0 || y < 0 || x >= width || y >= height) return null;
        const context = new OffscreenCanvas(1, 1).getContext("2d");
        context.fillStyle = "#fff";
        context.fillRect(0, 0, 1, 1);
        context.drawImage(this.#image, x, y, 1, 1, 0, 0, 1, 1);
        const [red, green, blue] = context.getImageData(0, 0, 1, 1).data;
        return `#${[red, green, blue].map((value) => value.toString(16).padStart(2, "0")).join("")}`;
    }

    #place() {
        const { scale, x, y } = this.view;
        this.#sheet.style.transform = `matrix(${scale}, 0, 0, ${scale}, ${x}, ${y})`;
        this.#root.classList.toggle("close", scale >= SQUARES);
        this.painter.ask();
    }

    #resize() {
        const { width, height } = this.#screen;
        this.#canvas.width = Math.round(width * devicePixelRatio);
        this.#canvas.height = Math.round(height * devicePixelRatio);
        this.painter.ask();
    }
}
