/** Keeps the whole page in a cache named by its content, so that it works without a network. */

// Both are set when the page is assembled.
const VERSION = "@VERSION@";
const FILES = "@FILES@".split(" ");

const CACHE = `fieldtrace-${VERSION}`;

async function keep() {
    const cache = await caches.open(CACHE);
    await cache.addAll(FILES.map((file) => new Request(file, { cache: "no-cache" })));
}

/** A new version takes over when no page of the old one is open: its parts belong together. */
async function takeOver() {
    const old = (await caches.keys()).filter((name) => name.startsWith("fieldtrace-") && name !== CACHE);
    await Promise.all(old.map((name) => caches.delete(name)));
    await self.clients.claim();
}

async function answer(request) {
    const cache = await caches.open(CACHE);
    return (await cache.match(request, { ignoreSearch: true })) ?? fetch(request);
}

self.addEventListener("install", (event) => event.waitUntil(keep()));
self.addEventListener("activate", (event) => event.waitUntil(takeOver()));
self.addEventListener("fetch", (event) => event.respondWith(answer(event.request)));
