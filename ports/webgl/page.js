// The page: run the shader over the cases of a pack, show what comes of it, and offer the results.
"use strict";

const element = name => document.getElementById(name);
const pause = milliseconds => new Promise(done => setTimeout(done, milliseconds));  // lets the page be drawn
const limits = {secondsPerCase: 60};

// WebGL is lost, so that no other case can be drawn either.
class Lost extends Fault {}

// ---- WebGL2.

const VERTEX = `#version 300 es
out vec2 vTexCoord;
void main()
{
    vTexCoord = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    gl_Position = vec4(vTexCoord * 2.0 - 1.0, 0.0, 1.0);
}`;

function openGl() {
    const gl = document.createElement("canvas").getContext("webgl2");
    if (!gl) throw new Fault("This browser has no WebGL2, or it is switched off.");
    if (!gl.getExtension("EXT_color_buffer_float"))
        throw new Fault("This browser cannot draw into float32 textures: it has no EXT_color_buffer_float.");
    return {gl, filters: gl.getExtension("OES_texture_float_linear") !== null};
}

// A program, the types of its uniforms by name, and the names of those that nothing has set yet.
function programOf(gl, source) {
    const program = gl.createProgram();
    for (const [kind, lines] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, source]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, lines);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
            throw new Fault(`The shader does not compile:\n${logWords(gl.getShaderInfoLog(shader), lines)}`);
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
        throw new Fault(`The shader does not link:\n${gl.getProgramInfoLog(program)}`);
    gl.useProgram(program);
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    const active = Array.from({length: count}, (_, i) => gl.getActiveUniform(program, i));
    const types = new Map(active.map(({name, type}) => [name, type]));
    return {program, types, unset: new Set(types.keys())};
}

// A compiler's log, "ERROR: 0:12: what", with the lines that it speaks of.
function logWords(log, source) {
    const lines = source.split("\n");
    return (log ?? "no log").replace(/\0/g, "").trim().split("\n").map(entry => {
        const [, line, said] = entry.match(/^ERROR: \d+:(\d+): (.*)$/) ?? [];
        return line ? `line ${line}: ${said}\n    ${(lines[line - 1] ?? "").trim()}` : entry;
    }).join("\n");
}

const uniformOf = key => "u" + key.split("_").map(word => word[0].toUpperCase() + word.slice(1)).join("");

// Values of all uniforms that a shader may have for a case.
function uniformsOf({params, width, height}) {
    const values = {
        uTexture: 0, uDepth: 1, uCoc: 2, uPixelSize: [1 / width, 1 / height],
        focusPoint: params.focus, focusScale: params.coc_scale / params.max_blur_size, uMaxTaps: 65536,
    };
    for (const [key, value] of Object.entries(params)) if (typeof value === "number") values[uniformOf(key)] = value;
    return values;
}

// The first parameter that is not the listing's and that the shader has no uniform for, in words; or undefined.
function unsupported({params, method}, types) {
    if (method !== "singlepass") return `method ${method}: this page runs singlepass`;
    const listing = {
        depth_filter: "nearest", color_filter: "bilinear", rad_scale: 0.5, max_blur_size: 20, behind_factor: 2,
        angle_start: 0, angle_step: 2.39996323, radius_start: params.rad_scale, loop_bound: params.max_blur_size,
        scale_x: 1, scale_y: 1, shift_x: 0, shift_y: 0, order: "depth", border: "clamp",
    };
    const own = [
        "method", "width", "height", "rows", "row_step", "row_order", "near", "far", "focus", "coc_scale", "precision",
    ];
    const bound = key => typeof params[key] === "number" && types.has(uniformOf(key));
    const key = Object.keys(params).find(key => !own.includes(key) && params[key] !== listing[key] && !bound(key));
    const number = typeof params[key] === "number";
    const lacks = number ? `the shader has no uniform ${uniformOf(key)}` : "there is no uniform for words";
    return key && `${key} is ${params[key]}: ${lacks}`;
}

// Rows of numbers in the reverse order.
function reversedRows(values, height) {
    const row = values.length / height, out = new values.constructor(values.length);
    for (let y = 0; y < height; y++) out.set(values.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
    return out;
}

// What the shader draws of a case: (H, W, 3), rows as the case has them.
async function render({gl, filters}, {program, types, unset}, one) {
    const {width, height, params} = one, count = width * height;
    const mirrored = params.row_step === -1 && !types.has("uRowStep");  // then all rows run the other way
    const ordered = values => mirrored ? reversedRows(values, height) : values;
    const color = new Float32Array(4 * count).fill(1);
    for (let i = 0; i < count; i++) color.set(one.color.subarray(3 * i, 3 * i + 3), 4 * i);
    const textures = [
        [gl.RGBA32F, gl.RGBA, ordered(color), filters ? gl.LINEAR : gl.NEAREST],
        [gl.R32F, gl.RED, ordered(one.depth.map(depth => depth / params.far)), gl.NEAREST],
        [gl.R32F, gl.RED, ordered(one.coc), gl.NEAREST],
        [gl.RGBA32F, gl.RGBA, null, gl.NEAREST],  // the target
    ].map(([inside, format, values, filter], unit) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texImage2D(gl.TEXTURE_2D, 0, inside, width, height, 0, format, gl.FLOAT, values);
        for (const [end, wrap] of [["MIN", "S"], ["MAG", "T"]]) {
            gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${end}_FILTER`], filter);
            gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_WRAP_${wrap}`], gl.CLAMP_TO_EDGE);
        }
        return texture;
    });
    gl.bindTexture(gl.TEXTURE_2D, null);  // nothing reads the target
    const target = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, textures[3], 0);
    for (const [name, value] of Object.entries(uniformsOf(one))) {
        const place = gl.getUniformLocation(program, name), type = types.get(name);
        if (type === gl.FLOAT_VEC2) gl.uniform2fv(place, value);
        else if (type === gl.FLOAT) gl.uniform1f(place, value);
        else if (type !== undefined) gl.uniform1i(place, value);
        unset.delete(name);
    }
    gl.viewport(0, 0, width, height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    await drawnIn(gl, limits.secondsPerCase);
    const drawn = new Float32Array(4 * count), image = new Float32Array(3 * count);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, drawn);
    const error = gl.getError();
    textures.forEach(texture => gl.deleteTexture(texture));
    gl.deleteFramebuffer(target);
    if (gl.isContextLost()) throw new Lost("The browser gave WebGL up: the shader may run for too long.");
    if (error) throw new Fault(`WebGL reports the error 0x${error.toString(16)}.`);
    for (let i = 0; i < count; i++) image.set(drawn.subarray(4 * i, 4 * i + 3), 3 * i);
    return ordered(image);
}

// Wait for what was drawn: readPixels would stop the page until then.
async function drawnIn(gl, seconds) {
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), end = performance.now() + 1000 * seconds;
    gl.flush();
    while (gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.UNSIGNALED) {
        if (performance.now() > end)
            throw new Lost(`Nothing was drawn within ${seconds} s: does the shader end? Close this page.`);
        await pause(1);
    }
    gl.deleteSync(fence);
}

// ---- What is shown.

function say(state, words) {
    document.body.dataset.state = state;
    element("message").textContent = words;
    element("message").className = state === "failed" ? "bad" : "";
}

// A picture for the eye only: upright, cut at 1, gamma 2.2; `shade(i)` gives red, green and blue of pixel i in 0 .. 1.
function preview({width, height, params}, shade) {
    const canvas = Object.assign(document.createElement("canvas"), {width, height});
    const scale = Math.min(150 / width, 100 / height), image = new ImageData(width, height);
    canvas.style.width = `${width * scale}px`;
    for (let i = 0; i < width * height; i++) {
        const y = Math.floor(i / width), row = params.rows === "up" ? height - 1 - y : y;
        image.data.set([...shade(i).map(value => 255 * Math.min(Math.max(value, 0), 1) ** (1 / 2.2)), 255],
                       4 * (row * width + i % width));
    }
    canvas.getContext("2d").putImageData(image, 0, 0);
    return canvas;
}

// Grey up to the tolerance, then red to yellow at 10 000 tolerances.
function heat(off) {
    return off <= 1 ? [off, off, off].map(value => 0.2 * value) : [1, Math.min(Math.log10(off) / 4, 1), 0];
}

function addRow(name, status, words, pictures) {
    const row = element("rows").insertRow();
    row.insertCell().append(name);
    for (let i = 0; i < 3; i++) row.insertCell().append(pictures[i] ?? "");
    const last = row.insertCell(), strong = document.createElement("strong"), small = document.createElement("small");
    strong.className = status.replace(" ", "-");
    strong.textContent = status;
    small.textContent = words;
    last.append(strong, small);
}

function show(one, image, seconds) {
    const found = judge(image, one), at = (values, i) => [...values.subarray(3 * i, 3 * i + 3)];
    const number = value => Number(value.toPrecision(6));
    const words = `${Number(found.worst.toPrecision(3))} tolerances, ${found.place}: got ${number(found.got)}, ` +
        `allowed ${number(found.low)} .. ${number(found.high)}; ${found.failing} values off; ${seconds.toFixed(2)} s`;
    addRow(one.name, found.status, words, [
        preview(one, i => at(image, i)), preview(one, i => at(one.expected, i)),
        preview(one, i => heat(Math.max(...at(found.off, i)))),
    ]);
    return found.status;
}

// ---- Running.

let pack = null;

async function run() {
    const progress = element("progress"), link = element("download"), results = [], counts = new Map();
    let context = null;
    element("run").disabled = element("folder").disabled = true;
    element("rows").replaceChildren();
    link.hidden = progress.hidden = element("table").hidden = true;
    say("running", "Reading the pack ...");
    try {
        const names = await casesOf(pack);
        context = openGl();
        const program = programOf(context.gl, element("shader").value);
        Object.assign(progress, {max: names.length, value: 0, hidden: false});
        element("table").hidden = false;
        const began = performance.now();
        for (const name of names) {
            say("running", `${progress.value} of ${names.length}: ${name}`);
            await pause(0);
            const status = await runCase(context, program, name, results);
            counts.set(status, (counts.get(status) ?? 0) + 1);
            progress.value++;
        }
        URL.revokeObjectURL(link.href);
        link.href = URL.createObjectURL(zipOf(results));
        link.hidden = false;
        const sums = [...counts].map(([status, count]) => `${count} ${status}`).join(", ");
        say("done", `${sums}; ${((performance.now() - began) / 1000).toFixed(1)} s.` + notesOf(context, program));
    } catch (error) {
        say("failed", error instanceof Fault ? error.message : `Unexpected: ${error.stack}`);
        if (error instanceof Lost) context = null;  // it would stop the page
    }
    context?.gl.getExtension("WEBGL_lose_context")?.loseContext();  // browsers allow few at a time
    progress.hidden = true;
    element("run").disabled = element("folder").disabled = false;
}

// Returns the status, and adds a file to `results`.
async function runCase(context, program, name, results) {
    try {
        const one = await readCase(pack, name), reason = unsupported(one, program.types);
        if (reason) {
            results.push([`${name}/not_supported.txt`, new TextEncoder().encode(reason + "\n")]);
            addRow(name, "not supported", reason, []);
            return "not supported";
        }
        const began = performance.now(), image = await render(context, program, one);
        results.push([`${name}/image.f32`, new Uint8Array(image.buffer)]);
        return show(one, image, (performance.now() - began) / 1000);
    } catch (error) {
        if (!(error instanceof Fault) || error instanceof Lost) throw error;
        addRow(name, "error", error.message, []);
        return "error";
    }
}

function notesOf({filters}, {unset}) {
    const notes = [...unset].map(name => `\nThe shader's uniform ${name} is none that the page sets: it was 0.`);
    if (!filters) notes.push("\nThis browser does not filter float32 textures (no OES_texture_float_linear): " +
                             "texture() reads the nearest texel. The page's own shader blends by hand.");
    return notes.join("");
}

async function load(makePack) {
    try {
        pack = await makePack();
    } catch (error) {
        return say("failed", error.message);
    }
    return run();
}

element("shader").value = element("singlepass").textContent;
element("run").onclick = run;
element("folder").onchange = event =>
    load(() => packOfFiles([...event.target.files].map(file => [file.webkitRelativePath, file])));
element("file").onchange = async event => { element("shader").value = await event.target.files[0].text(); };
addEventListener("dragover", event => { event.preventDefault(); element("pack").classList.add("over"); });
addEventListener("dragleave", () => element("pack").classList.remove("over"));
addEventListener("drop", event => {
    event.preventDefault();
    element("pack").classList.remove("over");
    const files = filesOfDrop(event.dataTransfer.items).catch(() => {  // Chromium, where the page is from the disk
        throw new Fault("This browser does not let the page read a dropped folder: choose it, or serve the page.");
    });
    if (document.body.dataset.state !== "running") load(async () => packOfFiles(await files));
});
const url = new URLSearchParams(location.search).get("pack");
if (url) load(() => packOfUrl(url));
