// Packs of refdof: read their cases, judge a picture by its bounds, and zip the results for `refdof check --results`.
"use strict";

// What is wrong, in words for the page.
class Fault extends Error {}

const text = bytes => new TextDecoder().decode(bytes);

// ---- Packs: functions from the path of a file to its bytes.

function packOfFiles(files) {
    const byPath = new Map(files);
    const manifests = [...byPath.keys()].filter(path => /(^|\/)manifest\.json$/.test(path));
    if (!manifests.length) throw new Fault("This folder is no pack: it has no manifest.json.");
    const shortest = manifests.reduce((one, other) => other.length < one.length ? other : one);
    const root = shortest.slice(0, -"manifest.json".length);
    return async path => {
        const file = byPath.get(root + path);
        if (!file) throw new Fault(`${path}: is missing`);
        return file.arrayBuffer().catch(() => {
            throw new Fault(`${path}: cannot be read. Has it changed? Choose the folder again.`);
        });
    };
}

function packOfUrl(url) {
    const base = new URL(url.replace(/\/?$/, "/"), location.href);
    return async path => {
        const answer = await fetch(new URL(path, base), {cache: "no-store"}).catch(() => {
            throw new Fault(`${path}: cannot be fetched from ${base}. Is the page served over http?`);
        });
        if (!answer.ok) throw new Fault(`${path}: is missing (status ${answer.status})`);
        return answer.arrayBuffer();
    };
}

async function filesOfDrop(items) {
    const files = [];
    const entries = [...items].map(item => item.webkitGetAsEntry()).filter(Boolean);  // before the first await
    while (entries.length) {
        const entry = entries.pop();
        if (entry.isFile) {
            files.push([entry.fullPath, await new Promise((yes, no) => entry.file(yes, no))]);
            continue;
        }
        const reader = entry.createReader();  // gives a hundred at a time
        let some;
        do {
            some = await new Promise((yes, no) => reader.readEntries(yes, no));
            entries.push(...some);
        } while (some.length);
    }
    return files;
}

async function json(pack, path) {
    try {
        return JSON.parse(text(await pack(path)));
    } catch (error) {
        throw error instanceof Fault ? error : new Fault(`${path}: is no JSON (${error.message})`);
    }
}

async function casesOf(pack) {
    const manifest = await json(pack, "manifest.json"), conventions = await json(pack, "conventions.json");
    if (manifest.schema !== "refdof-pack-1") throw new Fault("manifest.json: its schema is not refdof-pack-1");
    if (conventions.byte_order !== "little") throw new Fault("conventions.json: byte_order is not little");
    const names = manifest.cases;
    if (!Array.isArray(names) || !names.length || !names.every(name => /^[a-z0-9_]{1,80}$/.test(name)))
        throw new Fault("manifest.json: lists no cases, or names that are not allowed");
    return names;
}

// The numbers of an array of float32: NAME.f32, or NAME.npy of version 1.
async function numbers(pack, path, shape) {
    const bytes = await pack(path), count = shape.reduce((one, other) => one * other);
    let start = 0;
    if (path.endsWith(".npy")) {
        start = bytes.byteLength < 10 ? 0 : 10 + new DataView(bytes).getUint16(8, true);
        const header = text(bytes.slice(10, start));
        if (!header.includes("'<f4'") || header.includes("True")) throw new Fault(`${path}: is no NPY file of float32`);
    }
    if (bytes.byteLength - start !== 4 * count)
        throw new Fault(`${path}: has ${bytes.byteLength - start} bytes of numbers; ` +
                        `${shape.join(" x ")} float32 are ${4 * count}`);
    return new Float32Array(bytes.slice(start));
}

async function readCase(pack, name) {
    const folder = `cases/${name}`, about = await json(pack, `${folder}/case.json`);
    const lines = text(await pack(`${folder}/params.txt`)).trim().split("\n").map(line => line.split(" "));
    const params = Object.fromEntries(lines.map(([key, value]) => [key, isNaN(value) ? value : Number(value)]));
    try {
        const [width, height] = about.size, image = about.expected.image;
        const read = path => numbers(pack, `${folder}/${path}`, image.shape);
        const input = part => numbers(pack, `${folder}/${about.inputs[part].raw}`, about.inputs[part].shape);
        return {
            name, width, height, params, method: about.method, tolerance: image.tolerance,
            color: await input("color"), depth: await input("depth"), coc: await input("coc"),
            expected: await read(image.raw),
            low: await read(image.low ?? image.npy), high: await read(image.high ?? image.npy),
        };
    } catch (error) {
        throw error instanceof Fault ? error : new Fault(`${folder}/case.json: lacks something (${error.message})`);
    }
}

// ---- Verdicts, as `refdof check` has them.

// Each value's distance from low .. high in units of the tolerance, NaN counting as infinite, and what that comes to.
function judge(values, {low, high, tolerance, width}) {
    const off = new Float64Array(values.length);
    let worst = 0, failing = 0;
    for (let i = 0; i < values.length; i++) {
        const allowed = tolerance.max_abs + tolerance.max_rel * Math.max(Math.abs(low[i]), Math.abs(high[i]));
        const distance = Math.max(low[i] - values[i], values[i] - high[i], 0);
        off[i] = distance === 0 ? 0 : distance / allowed;
        if (Number.isNaN(off[i])) off[i] = Infinity;
        if (off[i] > 1) failing++;
        if (off[i] > off[worst]) worst = i;
    }
    const few = failing <= tolerance.max_failing_fraction * values.length && off[worst] <= tolerance.hard_factor;
    const pixel = Math.floor(worst / 3);
    return {
        off, failing, worst: off[worst], status: !failing ? "pass" : few ? "quality warning" : "fail",
        place: ["red", "green", "blue"][worst % 3] + ` at (${pixel % width}, ${Math.floor(pixel / width)})`,
        got: values[worst], low: low[worst], high: high[worst],
    };
}

// ---- Zip files, stored without compression: [[name, bytes]] to a Blob.

const CRC = Uint32Array.from({length: 256}, (_, n) => {
    for (let bit = 0; bit < 8; bit++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
    return n;
});

function zipOf(files) {
    const locals = [], directory = [];
    let offset = 0, directorySize = 0;
    for (const [name, bytes] of files) {
        const word = new TextEncoder().encode(name);
        const crc = ~bytes.reduce((sum, byte) => CRC[(sum ^ byte) & 255] ^ (sum >>> 8), -1);
        // Version, flags, method; time and date, 1980-01-01; digest, both sizes; length of the name, and of nothing.
        const about = [
            [2, 20], [2, 0], [2, 0], [2, 0], [2, 33], [4, crc], [4, bytes.length], [4, bytes.length],
            [2, word.length], [2, 0],
        ];
        const head = littleEndian([[4, 0x04034b50], ...about]);
        const entry = littleEndian([[4, 0x02014b50], [2, 20], ...about, [2, 0], [2, 0], [2, 0], [4, 0], [4, offset]]);
        locals.push(head, word, bytes);
        directory.push(entry, word);
        offset += head.length + word.length + bytes.length;
        directorySize += entry.length + word.length;
    }
    const counts = [[2, 0], [2, 0], [2, files.length], [2, files.length]];
    const end = littleEndian([[4, 0x06054b50], ...counts, [4, directorySize], [4, offset], [2, 0]]);
    return new Blob([...locals, ...directory, end], {type: "application/zip"});
}

// [[size in bytes, integer]] to bytes.
function littleEndian(fields) {
    return Uint8Array.from(fields.flatMap(([size, value]) => Array.from({length: size}, (_, i) => value >>> (8 * i))));
}
