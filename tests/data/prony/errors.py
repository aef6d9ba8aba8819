"""Errors of pyvisco on master.csv, as tests/prony.rs has them: pip install pyvisco==2.1.3; python errors.py

Relative root mean square of storage and loss modulus, for the series of the package with its relaxation times fixed (over
the exact window) and with times fitted as well (its module opt, window "min").
"""
import contextlib
import io
import os

import numpy as np
from pyvisco import load, master, prony

table, _ = load.user_master(load.file(os.path.join(os.path.dirname(os.path.abspath(__file__)), "master.csv")), "freq", 20, "E")
table = master.smooth(table, 1)
omega = 2 * np.pi * table["f"].values
for window, fitted in (("exact", False), ("min", True)):
    for terms in (5, 10, 15, 20):
        with contextlib.redirect_stdout(io.StringIO()):
            series, _ = prony.fit(prony.discretize(table, window, terms), table, opt=fitted)
        tau, alpha = series["df_terms"]["tau_i"].values, series["df_terms"]["alpha_i"].values
        z = 1j * omega[:, None] * tau
        modulus = series["E_0"] * (1 - alpha.sum() + (z / (1 + z)) @ alpha)
        rms = [np.sqrt(np.mean((of / table[name] - 1) ** 2)) for of, name in ((modulus.real, "E_stor"), (modulus.imag, "E_loss"))]
        print(f"{window} {len(tau)} terms: storage {rms[0]:.4f} loss {rms[1]:.4f}")
