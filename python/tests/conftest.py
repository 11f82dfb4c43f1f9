"""Settings of the test run: one BLAS thread, because BLAS threads that spin make busy machines crawl."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
