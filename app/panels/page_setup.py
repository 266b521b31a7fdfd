"""The page's look and keys: theme, a few rules of CSS, keys that leave the camera alone, hints, what of it is seen."""

from __future__ import annotations

import html
import json
from typing import NamedTuple

import viser

BRAND = (28, 108, 178)

# Only wishes: without them everything works and can be read. The picture that cannot be loaded runs its line once:
# viser turns and moves the camera with some of our keys, wherever they are pressed, a slider included; it shows hints
# over boxes only: here also over their labels, and those of plain buttons, which come in `add_hints`.
# IN_VIEW and NIGHT stand for hidden checkboxes: a page in the background takes the tick from one, and a browser that is
# set to dark pages gives the other one its tick. No :has() in the rules: with it the browser takes eight times as long
# over each change of the page, and many come in a second. On a phone viser puts all panels into one sheet, which would
# hide the vehicle. In labels it allows a break after each slash, which would part units. Small text is read at 4.5:1 at
# least (WCAG 2.2, 1.4.3), which the greys and blues that viser would take do not reach.
PAGE = """<img hidden src="data:," onerror="
  this.parentElement.dataset.trackride = 'page';
  this.parentElement.parentElement.dataset.trackride = 'panel';
  if (!document.body.dataset.trackride) {
    document.body.dataset.trackride = 'keys';
    document.body.addEventListener('keydown', (event) => {
      if (event.target.role === 'slider' && event.key.startsWith('Arrow')) event.stopPropagation();
    });
    document.documentElement.addEventListener('keydown', (event) => {
      if (['ArrowLeft', 'ArrowRight', 'KeyD', 'KeyS'].includes(event.code)) event.stopPropagation();
    });
    for (const [moved, into] of [['mouseover', 'mouseenter'], ['mouseout', 'mouseleave']]) {
      document.body.addEventListener(moved, ({target, clientX, clientY}) => {
        const button = target.closest?.('button[id]');
        if (button && !button.title)
          button.title = JSON.parse(document.getElementById('trackride-hints')?.dataset.hints ?? '{}')[button.id] ?? '';
        const name = target.closest?.('label[for]')?.closest('div[style]');
        const hinted = name?.nextElementSibling?.firstElementChild;
        hinted?.dispatchEvent(new PointerEvent('pointerover', {bubbles: true, pointerType: 'mouse'}));
        hinted?.dispatchEvent(new MouseEvent(into, {clientX, clientY}));
      });
    }
    const tick = (name, on) => {
      const box = document.getElementById(document.getElementById('trackride-style')?.dataset[name]);
      if (box && box.checked !== on) box.click();
    };
    document.addEventListener('visibilitychange', () => tick('inView', !document.hidden));
    const night = matchMedia('(prefers-color-scheme: dark)');
    const wish = () => tick('night', night.matches);
    night.addEventListener('change', wish);
    setTimeout(wish);
  }"><p class="trackride-intro">Move a slider: the run is computed anew. Ctrl+K: all keys.</p>
<style id="trackride-style" data-in-view="IN_VIEW" data-night="NIGHT">
  :root[data-mantine-color-scheme="light"] { --mantine-color-dimmed: #5c6670; --trackride-good: #087f5b;
    --trackride-bad: #c92a2a; --trackride-more: #b83a0a; --trackride-less: #1864ab;
    --mantine-color-custom-filled: var(--mantine-color-custom-8); --mantine-color-custom-outline:
    var(--mantine-color-custom-8); --mantine-color-custom-filled-hover: var(--mantine-color-custom-9); }
  :root[data-mantine-color-scheme="dark"] { --mantine-color-dimmed: #a3a3a3; --trackride-good: #3fc28f;
    --trackride-bad: #ff8787; --trackride-more: #ff9d5c; --trackride-less: #74b9ff; }
  :root[data-mantine-color-scheme="dark"] [role="tab"] {
    --mantine-primary-color-filled: var(--mantine-primary-color-4); }
  .mantine-Slider-markLabel, .mantine-Notification-description { color: var(--mantine-color-dimmed); }
  [data-trackride="page"] + div, [data-trackride="page"] + div + div,
  [data-trackride="page"] + div + div + div { display: none; }
  [data-trackride="panel"] { padding-right: 4px; }
  [data-trackride="panel"] div[style*="flex-shrink: 0"] { width: 9.6em !important; }
  [data-trackride="panel"] .mantine-Paper-root div[style*="flex-shrink: 0"] { width: 8.96em !important; }
  [data-trackride="panel"] div[style*="flex-shrink: 0"] > p { letter-spacing: -0.3px !important;
    font-size: 0.8em !important; }
  [data-trackride="panel"] > .mantine-Paper-root { margin-bottom: 1.15em !important; }
  label wbr { display: none; }
  @media (max-width: 36em) {
    .mantine-Paper-root[style*="max-height: 60%"] { width: 100% !important; max-height: 45% !important; }
    .mantine-Paper-root[style*="max-height: 60%"] div[style="width: 20em;"] { width: 100% !important; }
  }
  .trackride-intro { margin: -0.35em 0 0.6em; padding: 0 0.95em; font-size: 0.78em;
    color: var(--mantine-color-dimmed); }
  .trackride-status { font-size: 0.8em; line-height: 1.5; padding: 0 0.8em 0.5em; white-space: nowrap;
    overflow: hidden; text-overflow: ellipsis; color: var(--mantine-color-dimmed); }
  .trackride-status b { font-weight: 550; color: var(--mantine-color-text); }
  .trackride-status .bad { color: var(--trackride-bad); }
</style>"""


def apply_theme(gui: viser.GuiApi, dark: bool) -> None:
    """Colours of the page. No logo, and no share button: it would let any visitor open a public tunnel."""
    gui.configure_theme(dark_mode=dark, brand_color=BRAND, show_logo=False, show_share_button=False)


class PageSigns(NamedTuple):
    """Controls that nobody sees but the page sets."""

    in_view: viser.GuiCheckboxHandle  # ticked while the page is in view
    in_front: viser.GuiTextHandle  # names of the tabs in front, with commas between, once the page shows the panels
    night: viser.GuiCheckboxHandle  # ticked where the browser is set to dark pages


def add_page(gui: viser.GuiApi) -> PageSigns:
    """Add rules and keys, and what the page tells by; assets/plots.js writes which tabs are in front."""
    page = gui.add_html("")
    in_view = gui.add_checkbox("In view", True)
    in_front = gui.add_text("Tabs in front", "")
    night = gui.add_checkbox("Dark pages", False)
    page.content = PAGE.replace("IN_VIEW", in_view._impl.uuid).replace("NIGHT", night._impl.uuid)
    return PageSigns(in_view, in_front, night)


def add_hints(gui: viser.GuiApi) -> None:
    """Let the page show the hints of the plain buttons that there are by now: viser takes them and does not."""
    buttons = {
        uuid: handle.hint
        for uuid, handle in gui._gui_input_handle_from_uuid.items()
        if isinstance(handle, viser.GuiButtonHandle | viser.GuiUploadButtonHandle) and handle.hint
    }
    gui.add_html(f'<template id="trackride-hints" data-hints="{html.escape(json.dumps(buttons))}"></template>')
