"""Traces the folders of an archive with Spark: `spark-submit spark_batch.py ARCHIVE OUTPUT`.

OUTPUT gets a folder of Parquet files for each folder with scans, with one row for each scan. Spark writes such a folder as a
whole; one that it has finished is passed over, so that the same command goes on where it was stopped. All machines see ARCHIVE
and OUTPUT and have fieldtrace, pandas and pyarrow.
"""

import sys
from pathlib import Path
from urllib.parse import quote

import pandas as pd
from pyspark.sql import SparkSession

import fieldtrace


def record(path, result):
    """A row; of what cannot be traced too."""
    try:
        return path, result.drawing.encode("svg"), ""
    except Exception as error:
        return path, b"", f"{type(error).__name__}: {error}"


def traced(batches):
    """Rows with drawings of rows with contents of files. A process of Spark reads the networks once for all that it traces."""
    for rows in batches:
        results = fieldtrace.batch(list(rows["content"]), jobs=1, timeout=120).wait()
        yield pd.DataFrame(map(record, rows["path"], results), columns=["path", "drawing", "error"])


def main(archive: str, output: str) -> None:
    """Traces the folders that are left."""
    spark = SparkSession.builder.appName("fieldtrace").getOrCreate()
    # Drawings of as many scans are in memory at once.
    spark.conf.set("spark.sql.execution.arrow.maxRecordsPerBatch", 64)
    for folder in sorted({path.parent for path in Path(archive).resolve().rglob("*") if path.is_file()}):
        name = quote(str(folder.relative_to(Path(archive).resolve())), safe="")
        drawings = Path(output).resolve() / f"folder={name}"
        if not (drawings / "_SUCCESS").exists():
            scans = spark.read.format("binaryFile").load(str(folder))
            made = scans.mapInPandas(traced, "path string, drawing binary, error string")
            made.write.mode("overwrite").parquet(str(drawings))
    records = spark.read.parquet(output).select("path", "error")
    bad = records.where("error != ''").collect()
    print(f"{records.count() - len(bad)} drawings")
    for row in bad:
        print(f"{row.path}: {row.error}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
