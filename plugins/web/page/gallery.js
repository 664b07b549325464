/** Drawings to try. */

const SAMPLES = [
    ["kettle.png", "Kettle"],
    ["plan.png", "Plan"],
    ["boat.png", "Boat"],
    ["leaf.jpg", "Leaf"],
];

async function fetched(url, name) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${name} is not there`);
    return new File([await response.blob()], name);
}

/** Fills a list with buttons; `take(file)` gets what is chosen, `fail(text)` what went wrong. */
export function showGallery(list, take, fail) {
    for (const [name, text] of SAMPLES) {
        const url = `samples/${name}`;
        const button = document.createElement("button");
        button.type = "button";
        const image = new Image();
        image.src = url;
        image.alt = "";
        button.append(image, text);
        button.onclick = () => fetched(url, name).then(take, ({ message }) => fail(`This did not work: ${message}.`));
        const item = document.createElement("li");
        item.append(button);
        list.append(item);
    }
}
