/** The colours in which strokes are shown. */

/** Twelve hues far apart, all dark enough for white paper. */
const PENS = ["#1f5fa8", "#c2410c", "#15803d", "#9333ea", "#b91c1c", "#0e7490", "#a16207", "#be185d", "#4d7c0f", "#4338ca", "#57534e", "#0f766e"];

/** The golden angle: neighbours in the list get hues far apart, however many there are. */
const GOLDEN = 137.508;

const spread = (i) => `hsl(${((i * GOLDEN + 210) % 360).toFixed(1)} 75% 38%)`;

/** Fine is blue, broad is red. */
const scale = (share) => `hsl(${(250 * (1 - share)).toFixed(1)} 80% 40%)`;

const pixels = (width) => `${width.toFixed(2)} px`;

/** The pens of a drawing: the strokes of each colour and width. */
function pensOf(strokes) {
    const pens = new Map();
    for (const { color, width } of strokes) {
        const key = `${color} ${width.toFixed(2)}`;
        const pen = pens.get(key) ?? { color, width, count: 0, paint: PENS[pens.size % PENS.length] };
        pen.count += 1;
        pens.set(key, pen);
    }
    return pens;
}

function byPen({ strokes }) {
    const pens = pensOf(strokes);
    return {
        stroke: ({ color, width }) => pens.get(`${color} ${width.toFixed(2)}`).paint,
        legend: [...pens.values()].map(({ paint, color, width, count }) => [paint, `${color}, ${pixels(width)}: ${count}`]),
    };
}

function byWidth({ strokes }) {
    const widths = strokes.map(({ width }) => width).sort((a, b) => a - b);
    const [least, most] = [widths[0], widths.at(-1)];
    const paint = (width) => scale(most > least ? (width - least) / (most - least) : 0.5);
    const shown = most > least ? [least, (least + most) / 2, most] : widths.slice(0, 1);
    return { stroke: ({ width }) => paint(width), legend: shown.map((width) => [paint(width), pixels(width)]) };
}

const WAYS = {
    ink: () => ({ stroke: ({ color }) => color, legend: [] }),
    stroke: () => ({ stroke: (_, i) => spread(i), legend: [] }),
    pen: byPen,
    width: byWidth,
};

/** How a drawing is shown: `stroke(stroke, index)` gives a colour, `legend` pairs of a colour and what it means. */
export const coloring = (drawing, by) => WAYS[by](drawing);
