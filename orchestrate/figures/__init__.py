"""The paper's figures, one module each: data in, picture out. Only this folder sees matplotlib."""
