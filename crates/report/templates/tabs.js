for (const tabs of document.querySelectorAll(".tabs")) {
  const panels = [...tabs.querySelectorAll(":scope > .panel")];
  if (panels.length < 2) continue;
  const bar = document.createElement("div");
  bar.className = "tab-bar";
  const show = (chosen) => panels.forEach((panel, index) => {
    panel.classList.toggle("hidden", index !== chosen);
    bar.children[index].setAttribute("aria-pressed", index === chosen);
  });
  panels.forEach((panel, index) => {
    const button = document.createElement("button");
    button.textContent = panel.dataset.label;
    button.onclick = () => show(index);
    bar.append(button);
  });
  tabs.prepend(bar);
  show(0);
}
