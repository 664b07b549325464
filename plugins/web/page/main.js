/** Brings the parts of the page together. */

import { Desk } from "./desk.js";
import { save, takeFiles } from "./files.js";
import { showGallery } from "./gallery.js";
import { listen } from "./gestures.js";
import { takeKeys } from "./keys.js";
import { OptionsForm } from "./options.js";
import { Painter } from "./paint.js";
import { Picker } from "./picker.js";
import { Stage } from "./stage.js";
import { swatch } from "./swatch.js";
import { Tools } from "./tools.js";
import { View } from "./view.js";

const STAGES = {
    ink: "Telling ink from paper…",
    directions: "Finding the directions of lines…",
    strokes: "Following lines…",
    curves: "Fitting curves…",
};

const byId = (id) => document.getElementById(id);
const say = (text) => (byId("status").textContent = text);
const fail = (text) => (byId("error").textContent = text);

const desk = new Desk();
const view = new View();
const painter = new Painter(byId("strokes"), view);
const stage = new Stage(byId("stage"), view, painter);
const tools = new Tools(desk, stage, say);
const form = new OptionsForm(byId("options"), (options) => desk.set(options));
const picker = new Picker(desk, stage, tools, form);
desk.options = form.options;

function open(file) {
    fail("");
    tools.clear();
    desk.open({ blob: file, name: file.name || "drawing" });
}

function showDrawing() {
    const { drawing } = desk;
    const legend = painter.show(drawing, byId("coloring").value);
    const item = ([color, text]) => {
        const line = document.createElement("li");
        line.append(swatch(color), text);
        return line;
    };
    byId("legend").replaceChildren(...legend.map(item));
}

/** Which buttons have something to do. */
function showState() {
    const isReady = desk.drawing !== null && !desk.isTracing;
    const set = (ids, isUsable) => ids.forEach((id) => (byId(id).disabled = !isUsable));
    set(["undo"], isReady && desk.canUndo);
    set(["redo"], isReady && desk.canRedo);
    set(["edit", "previous", "next", "pick-only", "pick-ignore"], isReady);
    set(["delete"], isReady && tools.hasShape);
    set(["join"], isReady && tools.hasOpenStroke);
    set(["previous-junction", "next-junction", "switch"], isReady && tools.junctions > 0);
    for (const button of byId("downloads").children) button.disabled = desk.drawing === null;
    byId("junctions").textContent = `Junctions: ${tools.junctions}`;
    byId("progress").hidden = !desk.isTracing;
}

function changed() {
    tools.update();
    picker.update();
    showState();
}

function setEditing(isEditing) {
    tools.isEditing = isEditing;
    byId("edit").setAttribute("aria-pressed", isEditing);
    byId("edit-help").hidden = !isEditing;
    byId("stage").classList.toggle("editing", isEditing);
}

const toggleEditing = () => setEditing(byId("edit").getAttribute("aria-pressed") === "false");

const commands = {
    undo: () => desk.undo(),
    redo: () => desk.redo(),
    edit: toggleEditing,
    previous: () => tools.next(-1),
    next: () => tools.next(1),
    delete: () => tools.remove(),
    join: () => tools.join(),
    "previous-junction": () => tools.nextJunction(-1),
    "next-junction": () => tools.nextJunction(1),
    switch: () => tools.switch(),
    "zoom-in": () => stage.zoom(1.5, tools.place),
    "zoom-out": () => stage.zoom(1 / 1.5, tools.place),
    "zoom-fit": () => stage.fit(),
    cancel: () => desk.stop(),
};

/** Runs a command as its button does, which may have nothing to do. */
function run(name) {
    if (byId(name).disabled) return;
    commands[name]();
    showState();
}

for (const name of Object.keys(commands)) byId(name).addEventListener("click", () => run(name));
takeKeys(byId("strokes"), { run, pan: (dx, dy) => stage.pan(dx, dy), letGo: () => (picker.stop(), tools.clear(), showState()) });

listen(byId("strokes"), {
    grab: (place) => (picker.isPicking ? null : tools.grab(place)),
    pan: (dx, dy) => stage.pan(dx, dy),
    zoom: (factor, place) => stage.zoom(factor, place),
    tap(place) {
        if (!picker.pick(place)) tools.tap(place);
        showState();
    },
});

desk.addEventListener("picture", () => {
    document.body.classList.toggle("empty", desk.picture === null);
    stage.lay(desk.picture);
    if (!desk.picture) say("No drawing yet.");
    changed();
});
desk.addEventListener("options", () => (form.options = desk.options));
desk.addEventListener("start", () => {
    painter.forget();
    showState();
});
desk.addEventListener("stage", ({ detail }) => {
    say(STAGES[detail]);
    byId("progress").firstElementChild.value = Object.keys(STAGES).indexOf(detail) + 0.5;
});
desk.addEventListener("found", ({ detail }) => painter.find(detail));
desk.addEventListener("drawn", () => say(`${desk.picture.name}: ${desk.drawing.strokes.length} strokes.`));
desk.addEventListener("drawing", () => {
    fail("");
    stage.measure(desk.drawing);
    form.size = desk.drawing;
    showDrawing();
    changed();
});
desk.addEventListener("graph", changed);
desk.addEventListener("error", ({ detail }) => fail(`This did not work: ${detail}.`));
desk.addEventListener("stopped", () => say("Stopped."));
desk.addEventListener("end", () => {
    painter.forget();
    showState();
});

byId("fade").addEventListener("input", ({ target }) => stage.fade(target.value / 100));
stage.fade(byId("fade").value / 100);
byId("coloring").addEventListener("change", () => desk.drawing && showDrawing());
byId("downloads").addEventListener("click", async ({ target }) => {
    if (!target.dataset.format) return;
    try {
        await save(desk.drawing, target.dataset.format, desk.picture.name);
    } catch (error) {
        fail(`This did not work: ${error.message}.`);
    }
});
takeFiles({
    inputs: ["choose", "photograph"].map(byId),
    zone: byId("stage"),
    take: open,
});
showGallery(byId("gallery"), open, fail);

if ("serviceWorker" in navigator) {
    navigator.serviceWorker.register("sw.js");
    navigator.serviceWorker.ready.then(() => (byId("offline").hidden = false));
}
