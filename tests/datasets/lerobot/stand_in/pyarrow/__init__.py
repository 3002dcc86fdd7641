# SPDX-License-Identifier: Apache-2.0
"""Stands in for pyarrow, which Debian does not have: just what parquet_to_csv.py calls."""
