"""The page's look and keys: theme, a few rules of CSS, and which keys move the camera no more."""

from __future__ import annotations

import viser

BRAND = (28, 108, 178)

# Only wishes: without them everything works and can be read. The picture that cannot be loaded runs its line once:
# viser turns and moves the camera with some of our keys, wherever they are pressed, a slider included.
PAGE = """<img hidden src="data:," onerror="
  if (!document.body.dataset.trackride) {
    document.body.dataset.trackride = 'keys';
    document.body.addEventListener('keydown', (event) => {
      if (event.target.role === 'slider' && event.key.startsWith('Arrow')) event.stopPropagation();
    });
    document.documentElement.addEventListener('keydown', (event) => {
      if (['ArrowLeft', 'ArrowRight', 'KeyS'].includes(event.code)) event.stopPropagation();
    });
  }">
<style id="trackride-style">
  :has(> #trackride-style) ~ * div:has(> p > label[for]) { width: 9.6em !important; }
  :has(> #trackride-style) ~ .mantine-Paper-root div:has(> p > label[for]) { width: 8.96em !important; }
  :has(> #trackride-style) ~ * p:has(> label[for]) { letter-spacing: -0.3px !important; font-size: 0.8em !important; }
  .trackride-status { font-size: 0.8em; line-height: 1.5; padding: 0 0.8em 0.5em; white-space: nowrap;
    overflow: hidden; text-overflow: ellipsis; color: var(--mantine-color-dimmed); }
  .trackride-status b { font-weight: 550; color: var(--mantine-color-text); }
  .trackride-status .bad { color: var(--mantine-color-red-7); }
  :has(> #trackride-style) ~ .mantine-Paper-root { margin-bottom: 1.15em !important; }
  .uplot .u-legend { text-align: left !important; padding-left: 46px !important; margin-top: -0.3em; }
  .uplot .u-legend th::after { content: "" !important; }
  .uplot .u-legend .u-value { min-width: 2.9em; text-align: left; padding-left: 0.3em; }
  .uplot .u-legend .u-series:first-child, .uplot .u-legend .now { display: none; }
  body:not(:has(.uplot:hover)) .u-legend .u-value { visibility: hidden; }
</style>"""


def apply_theme(gui: viser.GuiApi, dark: bool) -> None:
    """Colours of the page. No logo, and no share button: it would let any visitor open a public tunnel."""
    gui.configure_theme(dark_mode=dark, brand_color=BRAND, show_logo=False, show_share_button=False)
