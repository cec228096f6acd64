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

  const connect = (figure) => {
    const drawing = figure.querySelector(".drawing");
    const svg = drawing.querySelector("svg");
    const table = figure.querySelector("details table");
    if (!svg || !table) return;
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

    const clear = () => {
      shown = -1;
      tip.hidden = true;
      for (const line of lines.splice(0)) line.remove();
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
    drawing.addEventListener("pointerleave", clear);
    drawing.addEventListener("blur", clear);
    drawing.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1, PageDown: 20, PageUp: -20 }[event.key];
      if (event.key === "Escape") { clear(); return; }
      if (!step || !rows.length) return;
      event.preventDefault();
      const index = Math.max(0, Math.min(rows.length - 1, (shown < 0 ? (step > 0 ? -1 : rows.length) : shown) + step));
      const box = drawing.getBoundingClientRect();
      show(index, box.left + box.width / 2, Math.max(box.top, 0) + 8);
    });
  };
  const all = (root) => root.querySelectorAll("figure.figure").forEach(connect);
  all(document);
  // Figures that were put into the page later.
  document.addEventListener("figures", (event) => { tip.hidden = true; all(event.detail); });
})();
