"""``python -m robotraj`` is ``robotraj``."""

from robotraj.cli import app

app()
