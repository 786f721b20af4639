"""Base of results over time: units, frames, plots."""

from ._channels import split

_MILLI = 1e3


class Series:
    """Arrays over time by name, "time" [s] among them. Derived classes define __getitem__ and info (name -> Column)."""

    def _label(self, name):
        unit = self.info[split(name)[0]].unit
        return name if unit == "1" else f"{name} [{unit}]"

    def frame(self, channels=None):
        """A pandas.DataFrame with the time [s] as index; channels of several numbers become columns "links/tension[0]", ...

        channels  names; None: all of one number per row
        Units by column are in frame.attrs["units"]. Raises ImportError where pandas is not installed.
        """
        import pandas

        names = [name for name, column in self.info.items() if column.width == 1] if channels is None else channels
        columns, units = {}, {}
        for name in names:
            values = self[name]
            parts = {name: values} if values.ndim == 1 else {f"{name}[{k}]": values[:, k] for k in range(values.shape[1])}
            columns.update(parts)
            units.update(dict.fromkeys(parts, self.info[split(name)[0]].unit))
        frame = pandas.DataFrame(columns, index=pandas.Index(self["time"], name="time"))
        frame.attrs["units"] = units
        return frame

    def plot(self, *channels, ax=None, **style):
        """Draws channels over time with Matplotlib: those of one unit in one panel, panels with a shared time axis. Returns the Axes, or
        an array of them.

        ax     Axes, or one for each unit; None: a new figure
        style  goes to Axes.plot
        """
        import matplotlib.pyplot as pyplot
        import numpy as np

        panels = {}
        for name in channels:
            panels.setdefault(self.info[split(name)[0]].unit, []).append(name)
        if not panels:
            raise TypeError("plot() takes the names of one channel or more")
        if ax is None:
            size = (6.4, max(3.6, 0.6 + 2.0 * len(panels)))
            ax = pyplot.subplots(len(panels), sharex=True, squeeze=False, figsize=size, layout="constrained")[1][:, 0]
        axes = np.atleast_1d(ax)
        for axis, (unit, names) in zip(axes, panels.items()):
            for name in names:
                axis.plot(_MILLI * self["time"], self[name], label=name, **style)
            axis.set_ylabel(self._label(names[0]) if len(names) == 1 else f"[{unit}]")
            if len(names) > 1:
                axis.legend()
        axes[-1].set_xlabel("time [ms]")
        return axes[0] if len(axes) == 1 else axes
