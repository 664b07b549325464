/** Serves a folder, as any web server does. */

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";

const TYPES = {
    ".html": "text/html",
    ".css": "text/css",
    ".js": "text/javascript",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".wasm": "application/wasm",
};

/** Gives `{ url, requests, close() }`; `requests` are the paths that were asked for. */
export async function serve(folder, port = 0) {
    const requests = [];
    const server = createServer(async (request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
        requests.push(path);
        const file = join(folder, path.endsWith("/") ? `${path}index.html` : path);
        try {
            const body = await readFile(file);
            response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" }).end(body);
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise((resolve) => server.listen(port, "localhost", resolve));
    const close = () => new Promise((resolve) => (server.close(resolve), server.closeAllConnections()));
    return { url: `http://localhost:${server.address().port}/`, requests, close };
}
