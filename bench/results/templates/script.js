"use strict";

const form = document.querySelector("form.filter");
const scenes = [...document.querySelectorAll("article.scene")];
const texts = new Map(scenes.map((scene) => [scene, scene.textContent.toLowerCase()]));

function filter() {
  const chosen = new FormData(form);
  const categories = chosen.getAll("category");
  const levels = chosen.getAll("level");
  const words = chosen.get("words").toLowerCase().split(/\s+/).filter(Boolean);
  let count = 0;
  for (const scene of scenes) {
    const shown =
      (!categories.length || categories.includes(scene.dataset.category)) &&
      (!levels.length || levels.includes(scene.dataset.level)) &&
      (!chosen.has("failed") || "failed" in scene.dataset) &&
      words.every((word) => texts.get(scene).includes(word));
    scene.hidden = !shown;
    count += shown;
  }
  form.querySelector("output").textContent = `${count} of ${scenes.length} scenes`;
}

form.hidden = false;
form.addEventListener("input", filter);
form.addEventListener("submit", (event) => event.preventDefault());
filter();

// A frame in large; its neighbours by the arrow keys.
const viewer = document.getElementById("viewer");
let frames = [];
let place = 0;

function show(step) {
  place = (place + step + frames.length) % frames.length;
  viewer.querySelector("img").src = frames[place].src;
  viewer.querySelector("p").textContent = frames[place].alt;
}

function open(image) {
  frames = [...image.closest(".frames").querySelectorAll("img")];
  place = frames.indexOf(image);
  show(0);
  viewer.showModal();
}

document.addEventListener("click", (event) => {
  if (viewer.open) viewer.close();
  else if (event.target.closest(".frames img")) open(event.target);
});
document.addEventListener("keydown", (event) => {
  if (viewer.open && event.key === "ArrowRight") show(1);
  else if (viewer.open && event.key === "ArrowLeft") show(-1);
  else if (!viewer.open && event.key === "Enter" && event.target.matches(".frames img")) open(event.target);
});
