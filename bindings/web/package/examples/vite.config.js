// Five pages. `npm install && npx vite`, then open /falling.html, /crowd.html, /shooter.html, /cloth.html or /react.html.
const pages = ['falling', 'crowd', 'shooter', 'cloth', 'react'];

export default {
  build: { target: 'esnext', rollupOptions: { input: Object.fromEntries(pages.map((page) => [page, `${page}.html`])) } },
  oxc: { jsx: { runtime: 'automatic' } },
  optimizeDeps: { exclude: ['sinew-physics'] },
};
