/** Starts the page. */

import { App } from "./app.js";
import { loadPayload } from "./payload.js";

loadPayload().then(
  (payload) => {
    const app = new App(payload);
    Object.assign(window, { explorer: app });
  },
  (error) => {
    const place = document.getElementById("status");
    if (place) place.textContent = `This browser cannot run the page: ${error}`;
  },
);
