(() => {
  "use strict";
  const by = (id) => document.getElementById(id);
  const [said, form, answer, command] = ["live-said", "live-levers", "live-answer", "live-command"].map(by);
  const REST_MS = 250;
  said.textContent = "Starting the simulator\u2026";

  // The simulator: each call is JSON in, JSON out. Its text is also that of the worker.
  const machine = async (bytes) => {
    // Libraries that it was built from name functions of a page which it never calls.
    const module = await WebAssembly.compile(bytes);
    const imports = {};
    for (const { module: from, name } of WebAssembly.Module.imports(module)) (imports[from] ??= {})[name] = () => { throw new Error(name); };
    const instance = await WebAssembly.instantiate(module, imports);
    const own = instance.exports;
    return (name, value) => {
      const text = new TextEncoder().encode(JSON.stringify(value));
      const room = own.live_reserve(text.length);
      new Uint8Array(own.memory.buffer, room, text.length).set(text);
      const length = own[name]();
      return JSON.parse(new TextDecoder().decode(new Uint8Array(own.memory.buffer, own.live_output(), length)));
    };
  };

  // Draws one state after the other, the last that was asked for; between two parts it listens.
  const drawing = () => {
    let call = null;
    let asked = null;
    let busy = false;
    const pause = () => new Promise((resume) => { setTimeout(resume); });
    const draw = async () => {
      busy = true;
      while (asked) {
        const now = asked;
        const found = call("live_draw", { state: now });
        if (found.drawn || found.problem) {
          if (asked === now) asked = null;
          postMessage({ state: now, ...found });
        }
        await pause();
      }
      busy = false;
    };
    onmessage = async ({ data }) => {
      if (data.bytes) { call = await machine(data.bytes); call("live_open", data.scene); postMessage({ ready: true }); } else { asked = data.state; }
      if (call && asked && !busy) draw();
    };
  };

  const inflated = async () => {
    const packed = Uint8Array.from(atob(by("live-program").textContent.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  };

  const scene = JSON.parse(by("live-scene").textContent);
  const levers = [...form.querySelectorAll("[data-lever]")];
  const fixed = { cycle: by("live-cycle"), ambient: by("live-ambient"), oil: by("live-oil"), against: by("live-against") };
  const inputs = [...Object.values(fixed), ...levers];
  const first = new Map(inputs.map((input) => [input, input.value]));
  const moved = new Set();

  const state = () => {
    const of = { cycle: fixed.cycle.value, ambient_degc: Number(fixed.ambient.value), lubricant: fixed.oil.value || null, against: fixed.against.value, levers: {} };
    for (const lever of levers) if (moved.has(lever)) of.levers[lever.id] = lever.value;
    return of;
  };
  const value = (input) => Number(input.value).toFixed(Number(input.dataset.decimals ?? 0));
  // Which car the figures are against does not matter to the draws.
  const drawnOf = (of) => JSON.stringify({ ...of, against: "" });
  const show = () => {
    for (const input of inputs) {
      const output = form.querySelector(`output[for="${input.id}"]`);
      if (!output) continue;
      const is = moved.has(input);
      const text = `${value(input).replace("-", "\u2212")}\u00a0${input.dataset.unit}`.trim();
      output.textContent = input.dataset.text && !is ? input.dataset.text : text;
      const half = Number(input.step) / 2;
      const beyond = is && input.dataset.low && (Number(input.value) < Number(input.dataset.low) - half || Number(input.value) > Number(input.dataset.high) + half);
      output.className = beyond ? "beyond" : is ? "moved" : "";
      input.setAttribute("aria-valuetext", output.textContent + (beyond ? ", outside the known range" : ""));
    }
  };

  // The state in the address: what differs from the first one.
  const address = () => {
    const parts = inputs.filter((input) => moved.has(input)).map((input) => `${encodeURIComponent(input.id)}=${encodeURIComponent(input.value)}`);
    return parts.length ? `#live&${parts.join("&")}` : "#live";
  };
  const read = () => {
    const [mark, ...parts] = location.hash.slice(1).split("&");
    if (mark !== "live") return;
    moved.clear();
    for (const [input, text] of first) input.value = text;
    for (const part of parts) {
      const [id, text] = part.split("=").map(decodeURIComponent);
      const input = inputs.find((one) => one.id === id);
      if (!input || text === undefined) continue;
      input.value = text;
      if (input.value) moved.add(input); else input.value = first.get(input);
    }
  };

  let call = null;
  let worker = null;
  let due = false;
  let resting = 0;
  let known = { key: drawnOf(state()), drawn: scene.drawn };

  const update = () => {
    due = false;
    const begun = performance.now();
    const now = state();
    const key = drawnOf(now);
    let found;
    try {
      found = call("live_answer", { state: now, drawn: known.key === key ? known.drawn : null });
    } catch (error) {
      said.textContent = `The simulator stopped (${error.message}); load the page again.`;
      form.hidden = true;
      return;
    }
    answer.innerHTML = found.html;
    command.textContent = found.command;
    document.dispatchEvent(new CustomEvent("figures", { detail: answer }));
    show();
    clearTimeout(resting);
    if (worker && found.can_draw && known.key !== key) {
      said.textContent = "The interval follows when the levers rest.";
      resting = setTimeout(() => { history.replaceState(null, "", address()); said.textContent = "Drawing the uncertain values\u2026"; worker.postMessage({ state: { ...now, against: "" } }); }, REST_MS);
    } else {
      resting = setTimeout(() => { history.replaceState(null, "", address()); said.textContent = found.failed ? "No such car." : found.can_draw ? "The answer is that of the levers, with its interval." : "The answer is that of the levers."; }, REST_MS);
    }
    performance.measure("live-answer", { start: begun });
  };
  const soon = () => { if (call && !due) { due = true; requestAnimationFrame(update); } };

  const drawn = ({ data }) => {
    if (data.ready) return;
    const key = drawnOf(data.state);
    if (key !== drawnOf(state())) return;
    known = { key, drawn: data.drawn };
    if (data.problem) said.textContent = `No interval: ${data.problem}`; else soon();
  };

  for (const input of inputs) {
    input.addEventListener("input", () => {
      if (input.type !== "range" && input.value === first.get(input)) moved.delete(input); else moved.add(input);
      show();
      soon();
    });
  }
  by("live-reset").addEventListener("click", () => { history.pushState(null, "", "#live"); read(); soon(); });
  const copy = async (text, button, words) => {
    try { await navigator.clipboard.writeText(text); } catch { getSelection().selectAllChildren(command); words = "Press Ctrl+C"; }
    const before = button.textContent;
    button.textContent = words;
    setTimeout(() => { button.textContent = before; }, 1500);
  };
  by("live-copy").addEventListener("click", (event) => copy(command.textContent, event.target, "Copied"));
  by("live-link").addEventListener("click", (event) => copy(location.href.split("#")[0] + address(), event.target, "Copied"));
  addEventListener("hashchange", () => { read(); soon(); });
  addEventListener("popstate", () => { read(); soon(); });

  (async () => {
    if (!("WebAssembly" in window) || !("DecompressionStream" in window)) {
      said.textContent = "This browser has no WebAssembly or cannot decompress: the levers are not there; this is the answer for the car as the page was made.";
      return;
    }
    try {
      const bytes = await inflated();
      call = await machine(bytes);
      const problem = call("live_open", scene);
      if (problem) throw new Error(problem);
      try {
        const source = `"use strict"; const machine = ${machine}; (${drawing})();`;
        worker = new Worker(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
        worker.onmessage = drawn;
        worker.postMessage({ bytes, scene });
      } catch { worker = null; }
    } catch (error) {
      said.textContent = `The levers are not there: ${error.message}. This is the answer for the car as the page was made.`;
      return;
    }
    form.hidden = false;
    read();
    update();
    document.documentElement.dataset.live = "ready";
  })();
})();
