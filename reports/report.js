(() => {
  "use strict";
  const root = document.documentElement;

  const button = document.querySelector("button.theme");
  const dark = () => (root.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
  const label = () => { button.textContent = dark() ? "Light" : "Dark"; button.setAttribute("aria-label", `Show on a ${dark() ? "light" : "dark"} page`); };
  button.hidden = false;
  button.addEventListener("click", () => { root.dataset.theme = dark() ? "light" : "dark"; label(); });
  label();

  const tip = document.createElement("div");
  tip.className = "tip";
  tip.hidden = true;
  document.body.append(tip);

  const number = (text) => Number(text.replace("\u2212", "-"));

  // Figures over time share one cursor.
  let traces = [];
  // The part of the time that they show: the whole of it, and its ends.
  let part = null;

  // The component that is pointed at is lit in all figures and tables.
  const components = new Set((document.querySelector("main").dataset.components ?? "").split(","));
  const plain = (text) => text.trim().toLowerCase();
  const component = (row) => [...row.cells].slice(0, 2).map((cell) => plain(cell.textContent)).find((name) => components.has(name)) ?? "";
  let lit = "";
  const light = (name) => {
    if (name === lit) return;
    lit = name;
    for (const one of document.querySelectorAll(".lit")) one.classList.remove("lit");
    if (!name) return;
    for (const table of document.querySelectorAll("main table")) {
      const marks = table.closest("figure.figure");
      [...table.tBodies[0].rows].forEach((row, index) => {
        if (component(row) !== name) return;
        row.classList.add("lit");
        marks?.querySelectorAll(`.drawing svg [data-row="${index}"]`).forEach((mark) => mark.classList.add("lit"));
      });
    }
  };
  document.querySelector("main").addEventListener("pointerover", (event) => {
    const row = event.target.closest?.("main tbody tr");
    if (row) { light(component(row)); return; }
    const mark = event.target.closest?.(".drawing svg [data-row]");
    const own = mark?.closest("figure.figure").querySelector("details table")?.tBodies[0].rows[Number(mark.dataset.row)];
    light(own ? component(own) : "");
  });

  // The table of a figure as CSV, with the units in its first row.
  const saved = (figure, table) => {
    const button = document.createElement("button");
    [button.type, button.className, button.textContent] = ["button", "csv", "CSV"];
    button.setAttribute("aria-label", `Save the numbers of ${figure.querySelector(".number")?.textContent ?? "the figure"} as CSV`);
    button.addEventListener("click", () => {
      const cell = (own) => { const text = own.textContent.trim().replace("\u2212", "-"); return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text; };
      const text = [...table.rows].map((row) => [...row.cells].map(cell).join(",")).join("\r\n");
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([`${text}\r\n`], { type: "text/csv" }));
      link.download = `${figure.id.replace(/^fig-/, "")}.csv`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
    figure.querySelector("figcaption")?.append(button);
  };

  const shape = (name, attributes) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  };

  // Data of the panels of a figure over time, to be drawn again over a part of it: paths and lines are moved, ticks made anew.
  let clips = 0;
  const zoomed = (svg, panels) => {
    const lowest = Math.max(...panels.map((panel) => panel.top));
    const parts = panels.map((panel) => {
      const inside = (one, below = 0) => { const box = one.getBBox(); const y = box.y + box.height / 2; return y >= panel.top - 1 && y <= panel.top + panel.tall + below + 1; };
      const of = (selector, below) => [...svg.querySelectorAll(selector)].filter((one) => !one.closest("defs, .legend") && inside(one, below));
      const paths = of("path").filter((path) => /^[MhvlZ\d\s.-]+$/.test(path.getAttribute("d"))).map((path) => [path, path.getAttribute("d")]);
      const lines = of("line:not(.cursor)").map((line) => [line, Number(line.getAttribute("x1"))]).filter(([line, x]) => Number(line.getAttribute("x2")) === x);
      const grid = of("polyline", 24).filter((line) => line.getBBox().width === 0);
      const under = panel.top < lowest ? [] : [...svg.querySelectorAll("text:not([transform])")].filter((text) => { const box = text.getBBox(); return box.y >= panel.top + panel.tall - 4 && box.y < panel.top + panel.tall + 60 && /^[\d.,\s\u2212\u202f]+$/.test(text.textContent); });
      return { panel, paths, lines, grid, under, whole: [panel.from, panel.to] };
    });
    for (const { panel, paths } of parts) {
      const id = `zoom-${clips += 1}`;
      const clip = shape("clipPath", { id });
      clip.append(shape("rect", { x: panel.left, y: panel.top, width: panel.wide, height: panel.tall }));
      svg.append(clip);
      for (const [path] of paths) if (!path.closest("[clip-path]")) path.setAttribute("clip-path", `url(#${id})`);
    }
    const ticks = [];
    return (from, to) => {
      ticks.splice(0).forEach((tick) => tick.remove());
      for (const { panel, paths, lines, grid, under, whole } of parts) {
        const [first, last] = whole;
        const a = (last - first) / (to - from);
        const b = panel.left + (first - from) / (to - from) * panel.wide - a * panel.left;
        const isWhole = from <= first && to >= last;
        [panel.from, panel.to] = [from, to];
        for (const [path, d] of paths) {
          path.setAttribute("d", isWhole ? d : d.replace(/([Mhl])([^MhvlZ]*)/g, (_, command, rest) => {
            const [x, y] = rest.match(/-?\d+(\.\d+)?/g).map(Number);
            const moved = (a * x + (command === "M" ? b : 0)).toFixed(1);
            return y === undefined ? `${command}${moved}` : `${command}${moved} ${y}`;
          }));
        }
        for (const [line, x] of lines) {
          const moved = a * x + b;
          line.setAttribute("x1", moved); line.setAttribute("x2", moved);
          line.style.display = moved < panel.left || moved > panel.left + panel.wide ? "none" : "";
        }
        for (const one of [...grid, ...under, ...svg.querySelectorAll("text.phase")]) one.style.display = isWhole ? "" : "none";
        if (isWhole || !under.length) continue;
        for (let k = 0; k <= 4; k += 1) {
          const tick = under[0].cloneNode();
          tick.style.display = "";
          tick.setAttribute("x", panel.left + panel.wide * k / 4);
          tick.textContent = (from + (to - from) * k / 4).toFixed(to - from < 20 ? 1 : 0);
          under[0].after(tick);
          ticks.push(tick);
        }
      }
    };
  };

  const connect = (figure) => {
    const table = figure.querySelector("details table");
    if (!table) return;
    saved(figure, table);
    for (const drawing of figure.querySelectorAll(".drawing")) connected(figure, drawing, table);
  };
  const connected = (figure, drawing, table) => {
    const svg = drawing.querySelector("svg");
    if (!svg) return;
    // The words of a title would come up as a second hint of the browser's own.
    const title = svg.querySelector(":scope > title");
    if (title) { svg.setAttribute("aria-label", title.textContent); title.remove(); }
    const heads = [...table.tHead.rows[0].cells].map((cell) => {
      const unit = (cell.querySelector(".unit") || { textContent: "" }).textContent;
      return [cell.textContent.slice(0, cell.textContent.length - unit.length).trim(), unit.replace(/[[\]]/g, "")];
    });
    const rows = [...table.tBodies[0].rows];
    const panels = [...svg.querySelectorAll("rect.plot[data-x0]")].map((rect) => ({
      left: rect.x.baseVal.value, top: rect.y.baseVal.value, wide: rect.width.baseVal.value, tall: rect.height.baseVal.value,
      from: Number(rect.dataset.x0), to: Number(rect.dataset.x1), rect,
      columns: rect.closest("[data-columns]")?.dataset.columns.split(" ").map(Number),
    }));
    let xs = null;
    let shown = -1;
    let said = null;
    const lines = [];
    const wipe = () => { for (const line of lines.splice(0)) line.remove(); };
    const draw = (at) => {
      wipe();
      for (const panel of panels) {
        const share = (at - panel.from) / (panel.to - panel.from);
        if (!(share >= 0 && share <= 1)) continue;
        const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
        const px = panel.left + share * panel.wide;
        line.setAttribute("class", "cursor");
        line.setAttribute("x1", px); line.setAttribute("x2", px);
        line.setAttribute("y1", panel.top); line.setAttribute("y2", panel.top + panel.tall);
        panel.rect.parentNode.append(line);
        lines.push(line);
      }
    };
    const own = { svg, draw, wipe };
    const isTrace = panels.length > 0 && heads[0][1] === "s";
    if (isTrace) { own.whole = [panels[0].from, panels[0].to]; traces.push(own); }
    const together = () => {
      traces = traces.filter((one) => one.svg.isConnected);
      return isTrace ? traces.filter((one) => one.svg.checkVisibility()) : [own];
    };

    const clear = () => {
      shown = -1;
      tip.hidden = true;
      for (const one of together()) one.wipe();
      for (const mark of svg.querySelectorAll(".at")) mark.classList.remove("at");
    };
    const place = (x, y) => {
      const box = tip.getBoundingClientRect();
      tip.style.left = `${Math.max(4, x + 14 + box.width > innerWidth ? x - 14 - box.width : x + 14)}px`;
      tip.style.top = `${Math.max(4, Math.min(innerHeight - box.height - 4, y + 10))}px`;
    };
    // Of a picture of many panels, what the one under the pointer shows.
    const show = (index, x, y, columns) => {
      if (index !== shown || columns !== said) {
        clear();
        shown = index;
        said = columns;
        const body = document.createElement("table");
        [...rows[index].cells].forEach((cell, k) => {
          if (!cell.textContent || (columns && k > 0 && !columns.includes(k))) return;
          const row = body.insertRow();
          const name = document.createElement("th");
          name.textContent = heads[k][0];
          row.append(name);
          row.insertCell().textContent = `${cell.textContent} ${heads[k][1]}`.trim();
        });
        tip.replaceChildren(body);
        for (const mark of svg.querySelectorAll(`[data-row="${index}"]`)) mark.classList.add("at");
        if (panels.length) {
          const at = number(rows[index].cells[0].textContent);
          for (const one of together()) one.draw(at);
        }
      }
      tip.hidden = false;
      place(x, y);
    };
    const nearest = (x) => {
      if (!xs) xs = rows.map((row) => number(row.cells[0].textContent));
      let best = -1;
      xs.forEach((own, k) => { if (best < 0 || Math.abs(own - x) < Math.abs(xs[best] - x)) best = k; });
      return best;
    };
    drawing.addEventListener("pointermove", (event) => {
      const mark = event.target.closest("[data-row]");
      if (mark && rows[mark.dataset.row]) { show(Number(mark.dataset.row), event.clientX, event.clientY); return; }
      const matrix = svg.getScreenCTM();
      if (!matrix || !panels.length) { clear(); return; }
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      const panel = panels.find((p) => at.x >= p.left && at.x <= p.left + p.wide && at.y >= p.top && at.y <= p.top + p.tall);
      const index = panel ? nearest(panel.from + (at.x - panel.left) / panel.wide * (panel.to - panel.from)) : -1;
      if (index >= 0) show(index, event.clientX, event.clientY, panel.columns); else clear();
    });
    // A part of the time is chosen by dragging, in all figures over the same time.
    own.zoom = (from, to) => {
      own.redraw ??= zoomed(svg, panels);
      own.redraw(from, to);
      if (!own.back) {
        own.back = document.createElement("button");
        [own.back.type, own.back.className, own.back.textContent] = ["button", "csv", "Whole cycle"];
        own.back.addEventListener("click", () => zoom(...own.whole));
        figure.querySelector("figcaption")?.append(own.back);
      }
      own.back.hidden = from <= own.whole[0] && to >= own.whole[1];
    };
    const zoom = (from, to) => {
      clear();
      const [first, last] = own.whole;
      part = { whole: own.whole, ends: [Math.max(first, from), Math.min(last, to)] };
      for (const one of together()) one.follow();
    };
    own.follow = () => {
      const same = part && own.whole.every((end, k) => Math.abs(end - part.whole[k]) < 2);
      if (same && svg.checkVisibility()) own.zoom(...part.ends);
    };
    const time = (x) => panels[0].from + (x - panels[0].left) / panels[0].wide * (panels[0].to - panels[0].from);
    const within = (event) => new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse()).x;
    let brush = null;
    if (isTrace) {
      drawing.addEventListener("pointerdown", (event) => {
        if (event.button !== 0 || event.pointerType === "touch") return;
        event.preventDefault();
        drawing.focus({ preventScroll: true });
        const x = within(event);
        const marks = panels.map((panel) => { const mark = shape("rect", { class: "brush", x, y: panel.top, width: 0, height: panel.tall }); svg.append(mark); return mark; });
        brush = { x, marks };
        drawing.setPointerCapture(event.pointerId);
      });
      drawing.addEventListener("pointermove", (event) => {
        if (!brush) return;
        const to = within(event);
        for (const mark of brush.marks) { mark.setAttribute("x", Math.min(brush.x, to)); mark.setAttribute("width", Math.abs(to - brush.x)); }
      });
      drawing.addEventListener("pointerup", (event) => {
        if (!brush) return;
        const { x, marks } = brush;
        brush = null;
        marks.forEach((mark) => mark.remove());
        const [from, to] = [time(x), time(within(event))].sort((a, b) => a - b);
        if (Math.abs(within(event) - x) > 40 && to - from >= 2) zoom(from, to);
      });
      drawing.addEventListener("dblclick", () => zoom(...own.whole));
    }
    drawing.addEventListener("pointerleave", clear);
    drawing.addEventListener("blur", clear);
    drawing.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1, PageDown: 20, PageUp: -20 }[event.key];
      if (event.key === "Escape") { clear(); return; }
      if (isTrace && (event.key === "+" || event.key === "-")) {
        event.preventDefault();
        const [from, to] = [panels[0].from, panels[0].to];
        const middle = shown >= 0 ? number(rows[shown].cells[0].textContent) : (from + to) / 2;
        const half = (to - from) * (event.key === "+" ? 0.25 : 1);
        if (half >= 1) zoom(middle - half, middle + half);
        return;
      }
      if (!step || !rows.length) return;
      event.preventDefault();
      const index = Math.max(0, Math.min(rows.length - 1, (shown < 0 ? (step > 0 ? -1 : rows.length) : shown) + step));
      const box = drawing.getBoundingClientRect();
      show(index, box.left + box.width / 2, Math.max(box.top, 0) + 8);
    });
  };
  // Figures that there are of several cars: the page shows those of one, and switches all of them together.
  const switched = () => {
    const views = [...document.querySelectorAll("figure.figure[data-view]")];
    const labels = [...new Set(views.map((view) => view.dataset.view))];
    const bars = [];
    const shown = (label) => {
      for (const view of views) {
        const own = views.filter((other) => other.dataset.group === view.dataset.group);
        const chosen = own.find((other) => other.dataset.view === label) ?? own[0];
        view.hidden = view !== chosen;
      }
      for (const bar of bars) for (const button of bar.children) button.setAttribute("aria-pressed", String(button.textContent === label));
      for (const one of traces) one.follow();
    };
    for (const first of views.filter((view) => !view.closest("details.view"))) {
      const bar = document.createElement("div");
      bar.className = "views";
      bar.setAttribute("role", "group");
      bar.setAttribute("aria-label", "Car that the figures show");
      for (const label of labels.filter((name) => views.some((view) => view.dataset.group === first.dataset.group && view.dataset.view === name))) {
        const button = document.createElement("button");
        [button.type, button.textContent] = ["button", label];
        button.addEventListener("click", () => { const top = bar.getBoundingClientRect().top; shown(label); scrollBy({ top: bar.getBoundingClientRect().top - top, behavior: "instant" }); });
        bar.append(button);
      }
      bars.push(bar);
      first.before(bar);
    }
    for (const details of document.querySelectorAll("details.view")) details.replaceWith(details.querySelector("figure.figure"));
    if (views.length) shown(views[0].dataset.view);
    // A link to a figure of another car shows it.
    const linked = () => { const view = views.find((one) => location.hash === `#${one.id}`); if (view?.hidden) { shown(view.dataset.view); view.scrollIntoView(); } };
    addEventListener("hashchange", linked);
    linked();
  };
  const all = (root) => root.querySelectorAll("figure.figure").forEach(connect);
  all(document);
  switched();
  // Figures that were put into the page later.
  document.addEventListener("figures", (event) => { tip.hidden = true; all(event.detail); });
})();
