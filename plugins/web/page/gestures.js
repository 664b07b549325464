/** From what pointers and wheels do to pans, zooms, taps and drags. */

/** A pointer that moved less than this has tapped. */
const TAP = 5;

const apart = ([a, b]) => Math.hypot(a[0] - b[0], a[1] - b[1]) || 1;
const middle = ([a, b]) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];

/**
 * Listens to an element. Places are on the element, in pixels of CSS.
 * `grab(place)` may give `{ move(place), drop(place), cancel() }` for a drag that begins there; else it pans.
 */
export function listen(element, { grab, pan, zoom, tap }) {
    const pointers = new Map();
    let held = null;
    let start = null;
    let hasMoved = false;
    const place = (event) => {
        const { left, top } = element.getBoundingClientRect();
        return [event.clientX - left, event.clientY - top];
    };

    function down(event) {
        if (event.button > 0) return;
        element.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, place(event));
        if (pointers.size === 1) {
            start = place(event);
            hasMoved = false;
            held = grab(start);
        } else {
            held?.cancel();
            held = null;
            hasMoved = true;
        }
    }

    function pinch(id, at) {
        const before = [...pointers.values()];
        pointers.set(id, at);
        const after = [...pointers.values()];
        const [from, to] = [middle(before), middle(after)];
        pan(to[0] - from[0], to[1] - from[1]);
        zoom(apart(after) / apart(before), to);
    }

    function move(event) {
        const at = place(event);
        const last = pointers.get(event.pointerId);
        if (!last) return;
        if (pointers.size > 1) return pinch(event.pointerId, at);
        hasMoved ||= apart([start, at]) >= TAP;
        if (!hasMoved) return;
        pointers.set(event.pointerId, at);
        if (held) held.move(at);
        else pan(at[0] - last[0], at[1] - last[1]);
    }

    function up(event) {
        if (!pointers.delete(event.pointerId) || pointers.size > 0) return;
        if (hasMoved) held?.drop(place(event));
        else {
            held?.cancel();
            tap(start);
        }
        held = null;
    }

    function cancel(event) {
        pointers.delete(event.pointerId);
        held?.cancel();
        held = null;
    }

    function wheel(event) {
        event.preventDefault();
        // Lines of Firefox's, and the pinch of a touchpad, which is sent as a wheel with Ctrl.
        const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1) * (event.ctrlKey ? 5 : 1);
        zoom(Math.exp(-pixels / 400), place(event));
    }

    element.addEventListener("pointerdown", down);
    element.addEventListener("pointermove", move);
    element.addEventListener("pointerup", up);
    element.addEventListener("pointercancel", cancel);
    element.addEventListener("wheel", wheel, { passive: false });
}
