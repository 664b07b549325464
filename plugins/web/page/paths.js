/** The strokes of a drawing as paths of a canvas. */

/** Pieces of a curve are sampled at so many places for outlines of varying width. */
const SAMPLES = 12;

/** A dot has no length, and canvases leave out what has none. */
const DOT = 1e-3;

function centreline({ beziers, closed }) {
    const path = new Path2D();
    path.moveTo(beziers[0], beziers[1]);
    for (let i = 0; i < beziers.length; i += 8) path.bezierCurveTo(...beziers.subarray(i + 2, i + 8));
    if (beziers.length === 8 && beziers[0] === beziers[6] && beziers[1] === beziers[7] && beziers[0] === beziers[2]) {
        path.lineTo(beziers[0] + DOT, beziers[1]);
    }
    if (closed) path.closePath();
    return path;
}

function at(curve, t) {
    const s = 1 - t;
    const [a, b, c, d] = [s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t];
    return [0, 1].map((k) => a * curve[k] + b * curve[2 + k] + c * curve[4 + k] + d * curve[6 + k]);
}

/** Places along a stroke, each with how far along it is. */
function sampled(beziers) {
    const places = [{ point: [beziers[0], beziers[1]], along: 0 }];
    for (let i = 0; i < beziers.length; i += 8) {
        for (let k = 1; k <= SAMPLES; k += 1) {
            const point = at(beziers.subarray(i, i + 8), k / SAMPLES);
            const last = places.at(-1);
            places.push({ point, along: last.along + Math.hypot(point[0] - last.point[0], point[1] - last.point[1]) });
        }
    }
    return places;
}

/** The outline of a stroke whose width varies: a round at each place, and the quadrilaterals between them. */
function outline({ beziers, widths }) {
    const places = sampled(beziers);
    const unit = (widths.length - 1) / places.at(-1).along;
    const path = new Path2D();
    let before = null;
    for (const { point: [x, y], along } of places) {
        const i = Math.min(widths.length - 2, Math.floor(along * unit));
        const radius = (widths[i] + (along * unit - i) * (widths[i + 1] - widths[i])) / 2;
        path.moveTo(x + radius, y);
        path.arc(x, y, radius, 0, 2 * Math.PI);
        if (before) {
            const angle = Math.atan2(y - before.y, x - before.x) - Math.PI / 2;
            const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
            path.moveTo(before.x + dx * before.radius, before.y + dy * before.radius);
            path.lineTo(x + dx * radius, y + dy * radius);
            path.lineTo(x - dx * radius, y - dy * radius);
            path.lineTo(before.x - dx * before.radius, before.y - dy * before.radius);
            path.closePath();
        }
        before = { x, y, radius };
    }
    return path;
}

/** Left, top, right and bottom of what a stroke may reach. */
function bounds({ beziers, width, widths }) {
    const reach = Math.max(width, ...(widths ?? [])) / 2;
    const made = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i < beziers.length; i += 2) {
        made[0] = Math.min(made[0], beziers[i] - reach);
        made[1] = Math.min(made[1], beziers[i + 1] - reach);
        made[2] = Math.max(made[2], beziers[i] + reach);
        made[3] = Math.max(made[3], beziers[i + 1] + reach);
    }
    return made;
}

/** What is painted of a stroke: its path, filled or drawn, and its bounds. */
export function pathOf(stroke) {
    const varies = stroke.widths?.length > 1;
    return { stroke, path: varies ? outline(stroke) : centreline(stroke), isFilled: varies, bounds: bounds(stroke) };
}
