// Begins: reads what the page was told, and shows what its address says.

const start = async () => {
  const told = JSON.parse(new TextDecoder().decode(await readBlock("scene")));
  const page = told.live ? new LivePage(told, new LiveSource(told))
    : told.plane ? new MapPage(told, await MapSource.load(told)) : new Page(told, await StoredSource.load(told));
  build(page);
  if (told.live) {
    buildParameters(page);
    connectPaths(page);
    connectEditor(page);
  }
  else if (told.plane) buildSecond(page);
  connect(page);
  connectPhases(page);
  page.restore(readAddress());
  // The page draws before the next picture of the screen; it is ready once that is done.
  requestAnimationFrame(() => {
    document.documentElement.dataset.ready = "true";
  });
};

start().catch((error) => {
  document.getElementById("says").textContent = `This page cannot be shown: ${error.message}.`;
  throw error;
});
