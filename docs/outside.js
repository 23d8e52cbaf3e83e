// Pages link to cases and tests of the repository, which are not in the book: there such a link becomes its text, which names the file.
const steps_up = (path) => path.match(/^(\.\.\/)*/)[0].length / 3;
for (const link of document.querySelectorAll("main a[href]")) {
  const path = link.getAttribute("href");
  if (steps_up(path) <= steps_up(path_to_root)) continue;
  const text = document.createElement("span");
  text.title = `in the repository: ${path.replace(/^(\.\.\/)*/, "").replace(/\.html/, ".md")}`;
  text.append(...link.childNodes);
  link.replaceWith(text);
}
