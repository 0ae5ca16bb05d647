"use strict";
const root = document.documentElement;
const scheme = document.getElementById("scheme");
const isDark = () => (root.style.colorScheme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
const label = () => { scheme.textContent = isDark() ? "Light" : "Dark"; };
scheme.hidden = false;
label();
scheme.addEventListener("click", () => { root.style.colorScheme = isDark() ? "light" : "dark"; label(); });

// Pictures open over the page; the arrows lead through them.
const viewer = document.getElementById("viewer");
const pictures = [...document.querySelectorAll("a.picture")];
let current = 0;
const show = (place) => {
  current = (place + pictures.length) % pictures.length;
  viewer.querySelector("img").src = pictures[current].querySelector("img").src;
  viewer.querySelector("p").textContent = pictures[current].title;
  if (!viewer.open) viewer.showModal();
};
pictures.forEach((picture, place) => picture.addEventListener("click", (event) => {
  if (event.ctrlKey || event.metaKey || event.shiftKey) return;
  event.preventDefault();
  show(place);
}));
viewer.addEventListener("keydown", (event) => {
  if (event.key === "ArrowRight") show(current + 1);
  if (event.key === "ArrowLeft") show(current - 1);
});
viewer.addEventListener("click", (event) => { if (event.target.tagName !== "P") viewer.close(); });

// On paper, what is folded can not be opened.
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open])")];
  folded.forEach((one) => { one.open = true; });
});
addEventListener("afterprint", () => folded.forEach((one) => { one.open = false; }));

// The contents follow the reader.
const links = new Map([...document.querySelectorAll("nav a[href^='#']")].map((link) => [link.hash.slice(1), link]));
const watch = new IntersectionObserver((entries) => entries.forEach((entry) => {
  if (!entry.isIntersecting) return;
  links.forEach((link) => link.classList.remove("here"));
  links.get(entry.target.id)?.classList.add("here");
}), { rootMargin: "-10% 0px -80% 0px" });
document.querySelectorAll("main section[id]").forEach((section) => watch.observe(section));
