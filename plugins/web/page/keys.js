/** The keys of the page. */

/** How far an arrow moves the drawing, pixels. */
const STEP = 60;

const COMMANDS = {
    ArrowRight: "next",
    ArrowLeft: "previous",
    ArrowDown: "next-junction",
    ArrowUp: "previous-junction",
    Delete: "delete",
    Backspace: "delete",
    j: "join",
    s: "switch",
    e: "edit",
    "+": "zoom-in",
    "=": "zoom-in",
    "-": "zoom-out",
    0: "zoom-fit",
};

const MOVES = { ArrowRight: [-STEP, 0], ArrowLeft: [STEP, 0], ArrowDown: [0, -STEP], ArrowUp: [0, STEP] };

/** Fields have an undo of their own. */
const isField = (element) => element.matches("input:not([type=range], [type=checkbox], [type=file]), select");

/** Listens on the drawing, and for undo and redo anywhere. `run(command)` is called by the names of buttons. */
export function takeKeys(element, { run, pan, letGo }) {
    element.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const move = event.shiftKey && MOVES[event.key];
        const command = COMMANDS[event.key] ?? COMMANDS[event.key.toLowerCase()];
        if (move) pan(...move);
        else if (command) run(command);
        else if (event.key === "Escape") letGo();
        else return;
        event.preventDefault();
    });
    addEventListener("keydown", (event) => {
        if (!(event.ctrlKey || event.metaKey) || isField(event.target)) return;
        const key = event.key.toLowerCase();
        if (key !== "z" && key !== "y") return;
        event.preventDefault();
        run(key === "y" || event.shiftKey ? "redo" : "undo");
    });
}
