/**
 * Workers, one job at a time each. A job that is aborted ends its worker: a trace has no place in which it could hear of it.
 */
export class Pool {
    #spawn;
    #size;
    #idle = [];
    #busy = 0;
    #queue = [];

    /**
     * `spawn()` gives a worker with `post(message, transfer)`, `listen(onMessage, onError)` and `end()`; there are never
     * more than `size` of them.
     */
    constructor(spawn, size) {
        this.#spawn = spawn;
        this.#size = size;
    }

    /** Runs a job and gives its result. `tell` is called with what the worker says on the way. */
    run(job, { transfer = [], signal, tell = () => {} } = {}) {
        return new Promise((resolve, reject) => {
            const entry = { job, transfer, signal, tell, resolve, reject };
            if (signal?.aborted) return reject(signal.reason);
            entry.drop = () => {
                this.#queue = this.#queue.filter((other) => other !== entry);
                reject(signal.reason);
            };
            signal?.addEventListener("abort", entry.drop, { once: true });
            this.#queue.push(entry);
            this.#next();
        });
    }

    /** Ends the workers that have nothing to do; others end with their job. */
    end() {
        this.#size = 0;
        for (const worker of this.#idle.splice(0)) worker.end();
    }

    #next() {
        while (this.#queue.length > 0 && (this.#idle.length > 0 || this.#busy < Math.max(1, this.#size))) {
            const entry = this.#queue.shift();
            entry.signal?.removeEventListener("abort", entry.drop);
            this.#start(entry, this.#idle.pop() ?? this.#spawn());
        }
    }

    #start({ job, transfer, signal, tell, resolve, reject }, worker) {
        this.#busy += 1;
        const finish = (isAlive, settle, value) => {
            signal?.removeEventListener("abort", abort);
            this.#busy -= 1;
            if (isAlive && this.#size > 0) this.#idle.push(worker);
            else worker.end();
            settle(value);
            this.#next();
        };
        const abort = () => finish(false, reject, signal.reason);
        signal?.addEventListener("abort", abort, { once: true });
        const hear = (message) => {
            if ("result" in message) finish(true, resolve, message.result);
            else if ("error" in message) finish(message.alive, reject, new Error(message.error));
            else tell(message);
        };
        worker.listen(hear, (error) => finish(false, reject, error));
        worker.post(job, transfer);
    }
}
