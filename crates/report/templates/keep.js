// Beneath each figure: the picture and, of charts, the numbers in it, as files.
const asFile = (text, type) => URL.createObjectURL(new Blob([text], { type }));
const slug = (text) => text.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "");
document.querySelectorAll("figure").forEach((figure, index) => {
  const svg = figure.querySelector("svg");
  if (!svg) return;
  const name = `${index + 1}-${slug(svg.querySelector("title")?.textContent ?? "figure")}`;
  const kept = { SVG: () => asFile(new XMLSerializer().serializeToString(svg), "image/svg+xml") };
  const table = svg.querySelector(":scope > metadata")?.textContent;
  if (table) kept.CSV = () => asFile(table, "text/csv");
  const canvas = figure.querySelector("canvas");
  if (canvas) kept.PNG = () => canvas.toDataURL();
  const row = document.createElement("p");
  row.className = "keep";
  for (const [kind, address] of Object.entries(kept)) {
    const link = document.createElement("a");
    link.textContent = kind;
    link.title = kind === "CSV" ? "Save the numbers in this figure" : "Save this figure";
    link.href = "#";
    link.download = `${name}.${kind.toLowerCase()}`;
    link.addEventListener("click", () => (link.href = address()));
    row.append(link);
  }
  figure.append(row);
});
