// A chapter of the book: a click on a picture runs its scene in place of the picture; only one scene runs at
// a time.
let running = null;

for (const button of document.querySelectorAll('button[data-scene]')) {
  button.addEventListener('click', () => {
    running?.();
    const frame = document.createElement('iframe');
    const address = new URLSearchParams({ scene: button.dataset.scene, panels: 'few' });
    const gpu = new URLSearchParams(location.search).get('gpu');
    if (gpu) address.set('gpu', gpu);
    frame.src = `viewer.html?${address}`;
    frame.title = `The scene ${button.dataset.scene} as it runs`;
    button.replaceWith(frame);
    running = () => frame.replaceWith(button);
  });
}
