/** Where the picture lies on the screen: `screen = scale * picture + (x, y)`, in pixels of CSS. */

const MOST_SCALE = 80;
const MARGIN = 24;

export class View {
    scale = 1;
    x = 0;
    y = 0;
    #least = 0.01;

    /** The place in the picture that a place on the screen shows. */
    toPicture([x, y]) {
        return [(x - this.x) / this.scale, (y - this.y) / this.scale];
    }

    toScreen([x, y]) {
        return [x * this.scale + this.x, y * this.scale + this.y];
    }

    /** Shows all of a picture, in the middle of the screen. */
    fit(picture, screen) {
        const [across, down] = [screen.width - 2 * MARGIN, screen.height - 2 * MARGIN];
        this.scale = Math.max(0.001, Math.min(across / picture.width, down / picture.height));
        this.#least = this.scale / 2;
        this.x = (screen.width - picture.width * this.scale) / 2;
        this.y = (screen.height - picture.height * this.scale) / 2;
    }

    pan(dx, dy) {
        this.x += dx;
        this.y += dy;
    }

    /** Zooms by a factor about a place on the screen, which keeps showing what it shows. */
    zoom(factor, [x, y]) {
        const scale = Math.min(MOST_SCALE, Math.max(this.#least, this.scale * factor));
        this.x = x - (x - this.x) * (scale / this.scale);
        this.y = y - (y - this.y) * (scale / this.scale);
        this.scale = scale;
    }

    /** Pans as far as it takes to show a box of the picture, or its middle where it is too large. */
    reveal([left, top, right, bottom], { width, height }) {
        const shift = (from, to, room) => {
            if (to - from > room - 2 * MARGIN) return from < room && to > 0 ? 0 : room / 2 - (from + to) / 2;
            return Math.max(0, MARGIN - from) + Math.min(0, room - MARGIN - to);
        };
        const [a, b] = [this.toScreen([left, top]), this.toScreen([right, bottom])];
        this.pan(shift(a[0], b[0], width), shift(a[1], b[1], height));
    }
}
