/** A patch of a colour. */
export function swatch(color) {
    const patch = document.createElement("span");
    patch.className = "swatch";
    patch.style.background = color;
    return patch;
}
