"""Rows of labelled pictures as one picture."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

GAP_PX = 6
LABEL_PX = 18
PAPER, INK = 0.12, 0.85  # grey of the background and of the text


def label(text, width_px):
    """A strip of text, LABEL_PX high."""
    figure = Figure(figsize=(width_px / 100, LABEL_PX / 100), dpi=100, facecolor=str(PAPER))
    canvas = FigureCanvasAgg(figure)  # draws without a display
    figure.text(0.0, 0.5, text, color=str(INK), size=9, va="center")
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3] / 255.0


def row_of(pictures):
    """Pictures of one height side by side."""
    gap = np.full((pictures[0].shape[0], GAP_PX, 3), PAPER)
    return np.concatenate([pictures[0], *(part for p in pictures[1:] for part in (gap, p))], axis=1)


def framed(rows):
    """Rows of one width below one another, with a margin."""
    body = np.concatenate([*rows, np.full((GAP_PX, rows[0].shape[1], 3), PAPER)])
    side = np.full((body.shape[0], GAP_PX, 3), PAPER)
    return np.concatenate([side, body, side], axis=1)


def panel(rows):
    """rows: lists of (label, picture), all pictures of one size; a picture of None is left blank."""
    shape = next(picture.shape for row in rows for _, picture in row if picture is not None)
    columns = max(len(row) for row in rows)
    parts = []
    for row in rows:
        cells = [*row, *[("", None)] * (columns - len(row))]
        parts.append(row_of([label(text, shape[1]) for text, _ in cells]))
        parts.append(row_of([np.full(shape, PAPER) if picture is None else picture for _, picture in cells]))
    return framed(parts)
