/** Files in: dropped, pasted, chosen, photographed. Files out: downloads. */

const TYPES = { svg: "image/svg+xml", dxf: "image/vnd.dxf", pdf: "application/pdf", json: "application/json" };

/** The first file of a drag or a paste. */
const fileOf = (data) => data?.files[0];

/** Takes files that are dropped on the page, pasted, or chosen with one of the inputs. */
export function takeFiles({ inputs, zone, take }) {
    for (const input of inputs) {
        input.addEventListener("change", () => {
            if (input.files[0]) take(input.files[0]);
            input.value = "";
        });
    }
    addEventListener("paste", ({ clipboardData }) => {
        const file = fileOf(clipboardData);
        if (file) take(file);
    });
    addEventListener("dragover", (event) => {
        event.preventDefault();
        zone.classList.add("over");
    });
    addEventListener("dragleave", ({ relatedTarget }) => relatedTarget ?? zone.classList.remove("over"));
    addEventListener("drop", (event) => {
        event.preventDefault();
        zone.classList.remove("over");
        const file = fileOf(event.dataTransfer);
        if (file) take(file);
    });
}

/** Saves a drawing as a file of a format, in millimetres where its size is known. */
export async function save(drawing, format, name) {
    const units = format === "svg" && drawing.dpi ? { units: "millimetres" } : {};
    const bytes = await drawing.encode(format, units);
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes], { type: TYPES[format] }));
    link.download = `${name.replace(/\.[^.]*$/, "")}.${format}`;
    link.click();
    // The browser has to have begun to read it.
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
