/** The states that undo and redo go through. */

/** Older states are forgotten. */
const MOST = 200;

export class History {
    #states = [];
    #at = -1;

    get now() {
        return this.#states[this.#at] ?? null;
    }

    get canUndo() {
        return this.#at > 0;
    }

    get canRedo() {
        return this.#at < this.#states.length - 1;
    }

    /** A state after the present one; what was undone cannot be redone any more. */
    push(state) {
        this.#states = [...this.#states.slice(0, this.#at + 1), state].slice(-MOST);
        this.#at = this.#states.length - 1;
    }

    undo() {
        if (this.canUndo) this.#at -= 1;
    }

    redo() {
        if (this.canRedo) this.#at += 1;
    }

    clear() {
        this.#states = [];
        this.#at = -1;
    }
}
