/** Strokes of SVG files, to compare them. */

const numbers = (text) => (text.match(/-?\d+(\.\d+)?/g) ?? []).map(Number);

/** The elements of an SVG that are strokes or solid regions: what they are, their look and their geometry. */
export function elements(svg) {
    const found = svg.replace(/<metadata>.*<\/metadata>/s, "").matchAll(/<(path|line|circle|rect) ([^>]*)>/g);
    return [...found].map(([, tag, text]) => {
        const { stroke, fill, "stroke-width": width, ...shape } = Object.fromEntries(
            [...text.matchAll(/([\w-]+)="([^"]*)"/g)].map(([, name, value]) => [name, value]),
        );
        const { d, x1, y1, x2, y2, ...others } = shape;
        const places = d ?? [x1, y1, x2, y2, ...Object.values(others)].join(" ");
        return { tag, color: stroke ?? fill, width: Number(width ?? 0), shape: numbers(places) };
    });
}

/** The points of a line or a path from its end to its start; arcs, which have other numbers too, stay as they are. */
function backwards(shape) {
    if (shape.length % 2 > 0) return shape;
    return shape.map((_, i) => shape[shape.length - (i % 2 === 0 ? i + 2 : i)]);
}

/** How far two elements are apart at most, whichever way they are walked; infinitely where they are not alike. */
function apart(a, b) {
    if (a.tag !== b.tag || a.color !== b.color || a.shape.length !== b.shape.length) return Infinity;
    const far = (shape) => Math.max(...a.shape.map((value, i) => Math.abs(value - shape[i])));
    return Math.max(Math.abs(a.width - b.width), Math.min(far(b.shape), far(backwards(b.shape))));
}

/** How far the strokes of an SVG are at most from those of another, in any order. */
export function difference(svg, other) {
    const [mine, others] = [elements(svg), elements(other)];
    if (mine.length !== others.length) return Infinity;
    const nearest = mine.map((a) => Math.min(...others.map((b) => apart(a, b))));
    return Math.max(...nearest);
}
