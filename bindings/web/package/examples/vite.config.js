// `npm install && npx vite` opens the front page; /falling.html, /crowd.html, /shooter.html, /cloth.html and /react.html are the examples.
const pages = ['index', 'falling', 'crowd', 'shooter', 'cloth', 'react'];

export default {
  build: { target: 'esnext', rollupOptions: { input: Object.fromEntries(pages.map((page) => [page, `${page}.html`])) } },
  oxc: { jsx: { runtime: 'automatic' } },
  optimizeDeps: { exclude: ['sinew-physics'] },
};
